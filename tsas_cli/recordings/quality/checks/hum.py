"""A channel oscillates at one frequency all the time, whatever the motion.

Mains hum aliased into the band, an inverter, a fan. Reported where the noise of a channel has
one narrow line, twenty times as strong as beside it and as strong in every part of the run.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import NoiseSpectrum, noise_spectrum
from tsas_cli.recordings.quality.trial import RunSignals

_SEGMENT_S = 2.0
_TIMES = 20.0  # the power beside the line
_BESIDE = 0.35  # of the line's frequency: how far to the sides that is taken


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels with a line in their noise."""
    if not trial.increases:
        yield CannotTell("time does not increase")
        return
    for name, values in trial.mechanical.items():
        whole = trial.is_noisy(name) and np.isfinite(values).all()
        spectrum = noise_spectrum(trial.time_s, values, _SEGMENT_S) if whole else None
        line = None if spectrum is None else _line(spectrum)
        if line is not None:
            yield Remark(
                "warning",
                f"{name} oscillates at about {line:.2g} Hz all the time, whatever the motion",
                "look for hum, aliased perhaps, and for what runs at this frequency; shield the "
                "cable, filter before sampling",
                name,
            )


def _line(spectrum: NoiseSpectrum) -> float | None:
    """Return the frequency of a line that stands out from the noise on both of its sides [Hz]."""
    frequency, power = spectrum.frequency_Hz, spectrum.power
    at = int(np.argmax(np.where(spectrum.is_steady, power, 0.0)))
    apart = np.abs(frequency / frequency[at] - 1.0) > _BESIDE
    below = np.flatnonzero(apart & (frequency < frequency[at]))[-2:]
    above = np.flatnonzero(apart & (frequency > frequency[at]))[:4]
    if not spectrum.is_steady[at] or not below.size or not above.size:
        return None
    stands_out = power[at] > _TIMES * max(power[below].max(), power[above].max())
    return float(frequency[at]) if stands_out else None


CHECK = QualityCheck("hum", find)
