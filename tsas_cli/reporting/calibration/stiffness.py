"""The stiffness of each phase: fitted, expected from the model, and by theory."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from tsas_cli.records.calibration import CalibrationFile, Stiffness
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section, Table, missing
from tsas_cli.reporting.drawing import picture, shortened
from tsas_cli.reporting.figures import legend
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain, with_interval
from tsas_cli.reporting.phases import BY_KEY, PHASES, label_of

_TITLE = "Stiffness by phase"
_WHAT = (
    "km is the slope of the tension at the drive over its displacement, fitted as a straight line "
    "in each phase."
)
_WHY = (
    "The same line fitted to the calibrated model stands beside it: in a dead band the tension is "
    "curved, so that a linear fit misses the theory of a lumped tendon without any sensor's fault."
)
_NAME_LENGTH = 14


def section(inputs: Inputs) -> Section:
    """Return the section of the stiffness in each phase."""
    calibration = inputs.get(CalibrationFile)
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
        f"{_sentence(note)}." if len(found) == len(rows) else f"{note}: {', '.join(found)}"
        for note, found in places.items()
    )


def _sentence(note: str) -> str:
    return note[:1].upper() + note[1:].rstrip(".")


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
        height_in=1.5 + 0.28 * len(rows),
    )


def draw_stiffness(figure: Any, rows: Sequence[Stiffness]) -> None:
    """Draw the rows of one phase, one line per run, the first on top."""
    axes = figure.add_subplot()
    phase = BY_KEY[rows[0].phase]
    _draw_measured(axes, rows, colour=STAND_IN[phase.colour])
    model = [row.expected_N_per_mm for row in rows]
    theory = [row.theory_N_per_mm for row in rows]
    _draw_marks(axes, model, marker="D", markersize=6, label="calibrated model")
    _draw_marks(axes, theory, marker="|", markersize=11, label="theory")
    axes.set_yticks(range(len(rows)), [shortened(row.run, _NAME_LENGTH) for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.margins(x=0.12)
    axes.set_xlabel(f"km in {phase.label} [N/mm]")
    legend(figure, ncols=3, handlelength=1.4)


def _draw_measured(axes: Any, rows: Sequence[Stiffness], *, colour: str) -> None:
    """Draw the fitted values, and their intervals where they have one."""
    values = [row.km.value for row in rows]
    _draw_marks(axes, values, marker="o", markersize=6, color=colour, label="measured, 95 %")
    for place, km in enumerate(row.km for row in rows):
        if km.interval_low is not None and km.interval_high is not None:
            ends = [km.interval_low, km.interval_high]
            axes.plot(ends, [place, place], marker="|", markersize=7, color=colour)


def _draw_marks(axes: Any, values: Sequence[float | None], **style: Any) -> None:
    """Draw one mark per run, none where there is no value."""
    there = [(value, place) for place, value in enumerate(values) if value is not None]
    look = {"color": STAND_IN["ink"], "markerfacecolor": "none", "markeredgewidth": 1.5} | style
    if there:
        axes.plot(*zip(*there, strict=True), linestyle="none", **look)
