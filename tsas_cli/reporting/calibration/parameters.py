"""The model's parameters with their intervals, and what the recordings do not say."""

from collections.abc import Sequence

from tsas_cli.records.base import ParameterValue
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.reporting.content import Section, Table, missing
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import with_interval

_TITLE = "Parameters"


def section(inputs: Inputs) -> Section:
    """Return the section of the parameters."""
    calibration = inputs.get(CalibrationFile)
    if calibration is None:
        return missing("parameters", _TITLE, what="calibration", stage="calibrate")
    intro = ["The origin says which values are fitted, and which are taken as given."]
    if not calibration.fit.converged:
        intro.append(f"The fit did not converge: {calibration.fit.message}")
    if calibration.cannot_tell:
        intro.append("Keep in mind:")
    tables = (table("The model's parameters", calibration.parameters),)
    return Section(
        "parameters", _TITLE, tuple(intro), tables=tables, points=calibration.cannot_tell
    )


def table(caption: str, parameters: Sequence[ParameterValue]) -> Table:
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
