"""The stiffness of each phase: fitted, expected from the model, and by theory."""

from functools import partial

from tsas_cli.records.calibration import Calibration, Stiffness
from tsas_cli.reporting.content import Picture, Section, Table, missing
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.stiffness import draw_stiffness, height_in
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain, with_interval
from tsas_cli.reporting.phases import PHASES, label_of

_TITLE = "Stiffness by phase"
_WHAT = (
    "km is the slope of the tension at the drive over its displacement, fitted as a straight line "
    "in each phase."
)
_WHY = (
    "The same line fitted to the calibrated model stands beside it: in a dead band the tension is "
    "curved, so that a linear fit misses the theory of a lumped tendon without any sensor's fault."
)


def section(inputs: Inputs) -> Section:
    """Return the section of the stiffness in each phase."""
    calibration = inputs.get(Calibration)
    if calibration is None:
        return missing("stiffness", _TITLE, what="calibration", stage="calibrate")
    rows = calibration.stiffness
    by_phase = ((phase.key, [row for row in rows if row.phase == phase.key]) for phase in PHASES)
    pictures = tuple(_picture(key, found) for key, found in by_phase if found)
    return Section(
        "stiffness",
        _TITLE,
        (_WHAT, _WHY),
        points=_notes(rows),
        tables=(_table(rows),),
        pictures=pictures,
    )


def _table(rows: tuple[Stiffness, ...]) -> Table:
    kr_unit = next((row.kr.unit for row in rows if row.kr), ABSENT)
    header = (
        "run",
        "phase",
        "km measured [N/mm]",
        "95 % interval",
        "calibrated model",
        "theory",
        "theory with elastic term",
        f"kr [{kr_unit}]",
        "95 % interval",
        "strokes",
    )
    return Table(
        "Stiffness by run and phase",
        header,
        tuple(_row(row) for row in rows),
        numeric=frozenset(range(2, 10)),
    ).without_empty()


def _row(row: Stiffness) -> tuple[str, ...]:
    kr = (row.kr.value, row.kr.interval_low, row.kr.interval_high) if row.kr else (None,) * 3
    return (
        row.run,
        label_of(row.phase),
        *with_interval(row.km.value, row.km.interval_low, row.km.interval_high),
        plain(row.expected_N_per_mm),
        plain(row.theory_N_per_mm),
        plain(row.theory_elastic_N_per_mm),
        *with_interval(*kr),
        str(row.occurrences),
    )


def _notes(rows: tuple[Stiffness, ...]) -> tuple[str, ...]:
    """Return each note once, with the rows that it holds for where it does not hold for all."""
    places: dict[str, list[str]] = {}
    for row in rows:
        if row.note:
            places.setdefault(row.note, []).append(f"{row.run} {label_of(row.phase)}")
    return tuple(
        note if len(found) == len(rows) else f"{note}: {', '.join(found)}"
        for note, found in places.items()
    )


def _picture(key: str, rows: list[Stiffness]) -> Picture:
    label = label_of(key)
    values = "; ".join(
        f"run {row.run} {plain(row.km.value)}, calibrated model "
        f"{plain(row.expected_N_per_mm)}, theory {plain(row.theory_N_per_mm)}"
        for row in rows
    )
    return picture(
        partial(draw_stiffness, rows=rows),
        key=f"stiffness-{key}",
        alt=f"Stiffness km in {label}, in newton per millimetre: {values}.",
        caption=f"{label.capitalize()}.",
        height_in=height_in(len(rows)),
    )
