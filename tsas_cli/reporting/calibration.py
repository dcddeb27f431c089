"""What a calibration says: the stiffness of each phase, the transfer of tension, the parameters."""

from collections.abc import Sequence
from typing import Any

from tsas_cli.identification.model_file import read_model
from tsas_cli.records.base import ParameterValue, parameters_of
from tsas_cli.records.calibration import CalibrationFile, Stiffness
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section, Table, missing, table_of
from tsas_cli.reporting.drawing import legend, picture, shortened
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import PHASES, label_of, role_of_phase
from tsas_cli.reporting.numbers import ABSENT, plain, value_and_interval

_PARAMETERS_TITLE = "Parameters"
_TRANSFER_TITLE = "Tension passed on"
_TRANSFER = (
    "While the whole tendon slips, the tension at the drive is a ratio times the tension at the "
    "load plus an intercept. The capstan alone gives the ratios e^(μθ) and e^(−μθ), and no "
    "intercepts; wrap is μθ."
)
_INTERCEPTS = (
    "Intercepts of opposite sign in the two directions are friction that does not depend on the "
    "load (constant_friction); a common part is an offset."
)
_NO_TRANSFER = (
    "It needs f_in_N and f_out_N, and slip in both directions with a tension that changes."
)
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
    by_phase = ((phase, [row for row in rows if row.phase == phase]) for phase in PHASES)
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
    return table_of("Stiffness by run and phase", header, map(_row, rows))


def _row(row: Stiffness) -> tuple[str, ...]:
    return (
        row.run,
        label_of(row.phase),
        *value_and_interval(row.km),
        plain(row.expected_N_per_mm),
        plain(row.theory_N_per_mm),
        plain(row.theory_elastic_N_per_mm),
        *value_and_interval(row.kr),
        str(row.occurrences),
    )


def _notes(rows: tuple[Stiffness, ...]) -> tuple[str, ...]:
    """Return each note once, with the rows that it holds for where it does not hold for all."""
    places: dict[str, list[str]] = {}
    for row in rows:
        if row.note:
            places.setdefault(row.note, []).append(f"{row.run} {label_of(row.phase)}")
    return tuple(
        f"{note[:1].upper()}{note[1:].rstrip('.')}."
        if len(found) == len(rows)
        else f"{note}: {', '.join(found)}"
        for note, found in places.items()
    )


def _picture(key: str, rows: list[Stiffness]) -> Picture:
    label, colour = label_of(key), STAND_IN[role_of_phase(key)]

    def draw(figure: Any) -> None:
        """Draw one line per run, the first on top, and the intervals where there are any."""
        axes = figure.add_subplot()
        km = [row.km for row in rows]
        style = {"marker": "o", "markersize": 6, "color": colour, "label": "measured, 95 %"}
        _draw_marks(axes, [one.value for one in km], **style)
        for place, one in enumerate(km):
            if one.interval_low is not None and one.interval_high is not None:
                ends = [one.interval_low, one.interval_high]
                axes.plot(ends, [place, place], marker="|", markersize=7, color=colour)
        model = [row.expected_N_per_mm for row in rows]
        theory = [row.theory_N_per_mm for row in rows]
        _draw_marks(axes, model, marker="D", markersize=6, label="calibrated model")
        _draw_marks(axes, theory, marker="|", markersize=11, label="theory")
        axes.set_yticks(range(len(rows)), [shortened(row.run, _NAME_LENGTH) for row in rows])
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.margins(x=0.12)
        axes.set_xlabel(f"km in {label} [N/mm]")
        legend(figure, ncols=3, handlelength=1.4)

    values = "; ".join(
        f"run {row.run} {plain(row.km.value)}, calibrated model "
        f"{plain(row.expected_N_per_mm)}, theory {plain(row.theory_N_per_mm)}"
        for row in rows
    )
    return picture(
        draw,
        key=f"stiffness-{key}",
        alt=f"Stiffness km in {label}, in newton per millimetre: {values}.",
        caption=f"{label.capitalize()}.",
        height_in=1.5 + 0.28 * len(rows),
    )


def _draw_marks(axes: Any, values: Sequence[float | None], **style: Any) -> None:
    """Draw one mark per run, none where there is no value."""
    marks = [(value, place) for place, value in enumerate(values) if value is not None]
    look = {"color": STAND_IN["ink"], "markerfacecolor": "none", "markeredgewidth": 1.5} | style
    if marks:
        axes.plot(*zip(*marks, strict=True), linestyle="none", **look)


def transfer_section(inputs: Inputs) -> Section:
    """Return the section of the tension's transfer."""
    calibration = inputs.get(CalibrationFile)
    if calibration is None:
        return missing("transfer", _TRANSFER_TITLE, what="calibration", stage="calibrate")
    if not calibration.transfer:
        return Section("transfer", _TRANSFER_TITLE, (_TRANSFER, _NO_TRANSFER))
    rows = [(p.run or "all", p.name, *value_and_interval(p), p.unit) for p in calibration.transfer]
    header = ("runs", "what", "value", "95 % interval", "unit")
    table = table_of("Ratios and intercepts", header, rows)
    return Section("transfer", _TRANSFER_TITLE, (_TRANSFER, _INTERCEPTS), tables=(table,))


def parameters_section(inputs: Inputs) -> Section:
    """Return the section of the parameters."""
    calibration, diagnosis = inputs.get(CalibrationFile), inputs.get(DiagnosisFile)
    extended = None
    if diagnosis is not None and diagnosis.extended:
        path = inputs.folders[DiagnosisFile] / EXTENDED_MODEL
        extended = read_model(path) if path.is_file() else None
    if calibration is None and extended is None:
        return missing("parameters", _PARAMETERS_TITLE, what="calibration", stage="calibrate")
    intro = ["The origin says which values are fitted, and which are taken as given."]
    tables, notes = [], tuple[str, ...]()
    if extended is not None:
        parameters = parameters_of(extended.estimates)
        tables.append(_parameter_table("The extended model", parameters, inputs))
    if calibration is not None:
        if not calibration.fit.converged:
            intro.append(f"The fit did not converge: {calibration.fit.message}")
        if notes := calibration.cannot_tell:
            intro.append("Keep in mind of the calibrated model:")
        tables.append(_parameter_table("The calibrated model", calibration.parameters, inputs))
    return Section(
        "parameters", _PARAMETERS_TITLE, tuple(intro), tables=tuple(tables), points=notes
    )


def _parameter_table(caption: str, parameters: Sequence[ParameterValue], inputs: Inputs) -> Table:
    """Return a model's parameters with their intervals, but those of channels in no run."""
    rows = tuple(
        (
            p.name,
            p.run or "all",
            *value_and_interval(p),
            p.unit,
            p.origin,
            "yes" if p.at_bound else "no",
        )
        for p in parameters
        if inputs.concerns(p.name)
    )
    header = ("parameter", "run", "value", "95 % interval", "unit", "origin", "at its bound")
    return table_of(caption, header, rows)
