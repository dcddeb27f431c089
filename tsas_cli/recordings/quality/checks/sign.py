"""A channel has the wrong sign.

Pulling at the drive is positive, the distal end follows it, and a tendon cannot push: over each
stroke of the drive the distal displacement and, with a spring as load, both tensions rise with
`x_in_mm`. If all other channels move opposite to the drive, the sign of the drive is wrong.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_CLEAR = 0.8


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels that move opposite to the drive, and the tensions of a pushing tendon."""
    pushing = [n for n in trial.mechanical if n.startswith("f_") and _pushes(trial, n)]
    scores = {name: trial.follows(name) for name in _followers(trial)}
    against = [name for name, score in scores.items() if score is not None and score < -_CLEAR]
    together = [name for name, score in scores.items() if score is not None and score > _CLEAR]
    if against and not together and not pushing and against != ["x_out_mm"]:
        yield _remark("x_in_mm", f"moves opposite to {', '.join(against)} in each stroke")
        return
    for name in against:
        yield _remark(name, "moves opposite to x_in_mm in each stroke")
    for name in pushing:
        if name in against:
            continue
        share = 100.0 * float(np.mean(trial.channels[name] < 0.0))
        yield _remark(name, f"is negative in {share:.3g} % of the samples; a tendon cannot push")
    if not against and not together and not pushing:
        yield CannotTell("no channel that follows x_in_mm moves visibly")


def _followers(trial: RunSignals) -> list[str]:
    """Return the channels that follow the drive; with a driven load, tensions need not."""
    spring = trial.recording.run.load == "spring"
    return [n for n in trial.mechanical if n == "x_out_mm" or (spring and n.startswith("f_"))]


def _pushes(trial: RunSignals, name: str) -> bool:
    values = trial.channels[name]
    return bool(np.nanpercentile(values, 98.0) < -trial.visible(name))


def _remark(column: str, what: str) -> Remark:
    return Remark(
        "error",
        f"{column} {what}",
        f"invert the sign of {column} at ingest, after checking how the sensor is mounted",
        column,
    )


CHECK = QualityCheck("sign", find, needs=("x_in_mm",), of_long="strokes")
