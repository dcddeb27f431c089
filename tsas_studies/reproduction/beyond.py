"""Beyond the paper: the disturbance observer against the adaptive sliding mode, on equal terms."""

from tsas_cli.paper import Paper
from tsas_studies.reproduction.closed_loops import CONDITIONS, READINGS, Reading, followed
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.verdicts import holds

OURS, THEIRS = "disturbance-observer", "adaptive-sliding-mode"
FRICTIONS = (0.7, 1.0, 1.3)  # of what the inverse model knows
AIMS = (  # number, what it is, at most this ratio
    ("rmse_N", "RMSE", 0.5),
    ("effort_rpm", "control effort", 1.0),
    ("chatter_rpm_per_s", "chatter", 1.0),
)
UNITS = {"rmse_N": "N", "effort_rpm": "rpm", "chatter_rpm_per_s": "rpm/s"}
_HOW = (
    "The same inverse model, feedforward, sensor and motor; in place of the sliding mode an "
    "observer that learns by which speed x_in misses what the motor should give. Each number is "
    "that of the observer over that of ASMC; the friction of the plant is 0.7, 1 and 1.3 times "
    "what the inverse model knows. Aimed at: half of the RMSE, no more effort, no more chatter."
)


def beyond(paper: Paper) -> Group:
    """Return how much better a controller of today does with the same sensor, motor and model."""
    del paper  # nothing printed is compared
    rows = [
        _row(condition, reading, friction, aim)
        for condition in CONDITIONS
        for reading in READINGS
        for friction in FRICTIONS
        for aim in AIMS
    ]
    return Group(
        "beyond",
        "Beyond the paper: a disturbance observer",
        (_HOW,),
        tuple(rows),
    )


def _row(condition: str, reading: Reading, friction: float, aim: tuple[str, str, float]) -> Row:
    number, words, most = aim
    ours = followed(OURS, condition, "per m", friction=friction).mean(number)
    theirs = followed(THEIRS, condition, reading, friction=friction).mean(number)
    return holds(
        f"{words} over that of ASMC, {condition}, ks {reading}, friction × {friction:g}",
        "aim of this project",
        true=ours / theirs <= most,
        criterion=f"in a ratio of at most {most:g}",
        ours=ours / theirs,
        because=f"it is {100.0 * (ours / theirs / most - 1.0):.2g} % more than that",
        evidence=f"{ours:.4g} and {theirs:.4g} {UNITS[number]}.",
    )
