"""Where the errors of both sides are: mean and scatter over the signals, on the same axes."""

from tsas_cli.comparing.compare import Comparison
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.diagnosis.maps import Panel, pictures

_WHAT = (
    "Measured minus simulated in units of the channel's noise, in the same bins for both: the mean "
    "in each, and bars of one standard deviation. Noise alone has its mean at zero and bars as "
    "long as the band."
)
_OWN = "No recording is in both, so that each side is shown on its own recordings."
_NOTHING = "Over no signal does the error of either side stand out of the noise."


def section(it: Comparison) -> Section:
    """Return the section of the residual maps."""
    panels = [
        Panel(channel, signal, bins, it.maps["b"][channel][signal])
        for channel, signals in it.maps["a"].items()
        for signal, bins in signals.items()
    ]
    shown = pictures(panels, key="map", names=("A", "B"))
    intro = () if it.shared else (_OWN,)
    return Section("maps", "Where the errors are", (*intro, _WHAT if shown else _NOTHING),
                   pictures=shown)  # fmt: skip
