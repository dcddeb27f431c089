"""A channel moves in steps that are coarse for its noise and its range.

A note if the step is more than twice the noise, so that averaging does not resolve it, and more
than a 500th of the range; a warning from a 50th of the range on.
"""

from collections.abc import Iterator

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_NOTE, _WARNING = 1 / 500, 1 / 50


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels whose step exceeds their noise and a share of their span."""
    for name in trial.mechanical:
        step, noise, span = trial.sizes[name].step, trial.sizes[name].noise, trial.sizes[name].span
        if step <= max(2.0 * noise, _NOTE * span) or span == 0.0:
            continue
        coarse = step > _WARNING * span and name != trial.prescribed
        unit = name.rsplit("_", 1)[1]
        yield Remark(
            "warning" if coarse else "note",
            f"{name} moves in steps of {step:.4g} {unit}, {100 * step / span:.2g} % of its range "
            f"of {span:.4g} {unit}; its noise is {noise:.2g} {unit}",
            "use a finer resolution or a smaller measuring range, if residuals below a step matter",
            name,
        )


CHECK = QualityCheck("quantised", find, of_long="decimated")
