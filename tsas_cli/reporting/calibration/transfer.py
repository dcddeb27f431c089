"""How tension passes through the sheath in both directions, where both ends were measured."""

from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.reporting.content import Section, Table, missing
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import with_interval

_TITLE = "Tension passed on"
_WHAT = (
    "While the whole tendon slips, the tension at the drive is a ratio times the tension at the "
    "load plus an intercept. The capstan alone gives two ratios whose product is 1, and no "
    "intercepts."
)
_WHY = (
    "Intercepts of opposite sign in the two directions are friction that does not depend on the "
    "load (constant_friction); a common part is an offset."
)
_NONE = "It needs f_in_N and f_out_N, and slip in both directions with a tension that changes."


def section(inputs: Inputs) -> Section:
    """Return the section of the tension's transfer."""
    calibration = inputs.get(CalibrationFile)
    if calibration is None:
        return missing("transfer", _TITLE, what="calibration", stage="calibrate")
    if not calibration.transfer:
        return Section("transfer", _TITLE, (_WHAT, _NONE))
    rows = tuple(
        (p.run or "all", p.name, *with_interval(p.value, p.interval_low, p.interval_high), p.unit)
        for p in calibration.transfer
    )
    header = ("runs", "what", "value", "95 % interval", "unit")
    table = Table("Ratios and intercepts", header, rows, numeric=frozenset({2, 3}))
    return Section("transfer", _TITLE, (_WHAT, _WHY), tables=(table,))
