"""The model's parameters with their intervals, and what the recordings do not say."""

from tsas_cli.records.base import Parameter
from tsas_cli.records.calibration import Calibration
from tsas_cli.reporting.content import Section, Table, missing
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import with_interval

_TITLE = "Parameters"


def section(inputs: Inputs) -> Section:
    """Return the section of the parameters."""
    calibration = inputs.get(Calibration)
    if calibration is None:
        return missing("parameters", _TITLE, what="calibration", stage="calibrate")
    intro = ["The origin says which values are fitted, and which are taken as given."]
    if not calibration.fit.converged:
        intro.append(f"The fit did not converge: {calibration.fit.message}")
    if calibration.cannot_tell:
        intro.append("Keep in mind:")
    header = ("parameter", "run", "value", "95 % interval", "unit", "origin", "at its bound")
    table = Table(
        "The model's parameters",
        header,
        tuple(_row(parameter) for parameter in calibration.parameters),
        numeric=frozenset({2, 3}),
    )
    return Section(
        "parameters", _TITLE, tuple(intro), tables=(table,), points=calibration.cannot_tell
    )


def _row(parameter: Parameter) -> tuple[str, ...]:
    return (
        parameter.name,
        parameter.run or "all",
        *with_interval(parameter.value, parameter.interval_low, parameter.interval_high),
        parameter.unit,
        parameter.origin,
        "yes" if parameter.at_bound else "no",
    )
