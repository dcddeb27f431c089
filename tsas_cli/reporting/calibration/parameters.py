"""The model's parameters with their intervals, and what the recordings do not say."""

from collections.abc import Sequence
from typing import TypeVar

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_model
from tsas_cli.records.base import ParameterValue
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile
from tsas_cli.reporting.content import Section, Table, missing
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import with_interval

_TITLE = "Parameters"
Shown = TypeVar("Shown", ParameterValue, Estimate)


def section(inputs: Inputs) -> Section:
    """Return the section of the parameters."""
    calibration, extended = inputs.get(CalibrationFile), _extended(inputs)
    if calibration is None and extended is None:
        return missing("parameters", _TITLE, what="calibration", stage="calibrate")
    intro = ["The origin says which values are fitted, and which are taken as given."]
    tables, notes = [], tuple[str, ...]()
    if extended is not None:
        tables.append(table("The extended model", _shown(extended.estimates, inputs)))
    if calibration is not None:
        if not calibration.fit.converged:
            intro.append(f"The fit did not converge: {calibration.fit.message}")
        if notes := calibration.cannot_tell:
            intro.append("Keep in mind of the calibrated model:")
        tables.append(table("The calibrated model", _shown(calibration.parameters, inputs)))
    return Section("parameters", _TITLE, tuple(intro), tables=tuple(tables), points=notes)


def _extended(inputs: Inputs) -> Model | None:
    """Return the extended model of a diagnosis, None without one."""
    diagnosis = inputs.get(DiagnosisFile)
    if diagnosis is None or not diagnosis.extended:
        return None
    path = inputs.folders[DiagnosisFile] / EXTENDED_MODEL
    return read_model(path) if path.is_file() else None


def _shown(parameters: Sequence[Shown], inputs: Inputs) -> list[Shown]:
    return [p for p in parameters if inputs.concerns(p.name)]


def table(caption: str, parameters: Sequence[ParameterValue | Estimate]) -> Table:
    """Return a model's parameters with their intervals."""
    rows = tuple(
        (
            p.name,
            p.run or "all",
            *with_interval(p.value, p.interval_low, p.interval_high),
            p.unit,
            p.origin,
            "yes" if p.at_bound else "no",
        )
        for p in parameters
    )
    header = ("parameter", "run", "value", "95 % interval", "unit", "origin", "at its bound")
    return Table(caption, header, rows, numeric=frozenset({2, 3}))
