"""From the units of a lab to the units of the canonical columns."""

import re
from functools import cache
from typing import Any

from tsas_cli.errors import InputError

# What people write in header lines and what pint would read otherwise or not at all: it takes
# `Nm` for number-metre, `1/min` for radians per minute and `U` for an enzyme unit.
_SPELLINGS = {
    '"': "inch",
    "''": "inch",
    "U/min": "rpm",
    "1/min": "rpm",
    "/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "rev/min": "rpm",
    "r/min": "rpm",
    "rev": "turn",
    "revs": "turn",
    "rev/s": "turn/s",
    "rps": "turn/s",
    "deg C": "degC",
    "deg F": "degF",
    "in-lb": "lbf*inch",
    "in-lbf": "lbf*inch",
    "lb-in": "lbf*inch",
    "lbf-in": "lbf*inch",
    "ft-lb": "lbf*foot",
    "ft-lbf": "lbf*foot",
    "lbf-ft": "lbf*foot",
}
_AS_FORCE = {"lb": "lbf", "lbs": "lbf", "kg": "kgf", "g": "gf", "oz": "ozf", "kp": "kgf"}
_AS_TEMPERATURE = {"C": "degC", "F": "degF"}
_LABELS = {"count", "counts", "cts", "pulse", "pulses", "tick", "ticks", "inc", "V", "mV", "volt"}
_TORQUE = re.compile(r"([mkM]?N)(mm|cm|m)")
_ANGLES = ("radian", "degree", "turn", "revolution", "arc_minute", "arc_second", "grade")


def conversion(
    unit: str,
    to: str,
    *,
    factor: float | None = None,
    factor_unit: str | None = None,
    pulley_radius_mm: float | None = None,
) -> tuple[float, float]:
    """Return slope and intercept that take a number in a file to a canonical unit.

    Parameters
    ----------
    unit
        The unit as text, as people write it.
    to
        The canonical unit: s, mm, N, rpm, rad or °C.
    factor, factor_unit
        What one of `unit` is, for counts and volts: `factor` times `factor_unit`.
    pulley_radius_mm
        The radius on which an angle becomes mm, or a torque N.

    Raises
    ------
    InputError
        The unit is unknown, or cannot become the canonical one; says what to add.
    """
    if unit.strip() in _LABELS and factor is None:
        raise InputError(
            f"{unit!r} does not say how many {to} one is",
            remedy="say what one is: factor and factor_unit",
        )
    source = _parse(factor_unit or unit, to)
    wanted = _parse(to, to)
    scale = 1.0 if factor is None else factor
    if pulley_radius_mm is not None:
        source = _on_pulley(source, to, pulley_radius_mm, unit)
    if not _fits(source, wanted):
        raise _cannot_become(source, to, factor_unit or unit)
    zero, one = (
        float(_registry().Quantity(x, source.units).to(wanted.units).magnitude) for x in (0.0, 1.0)
    )
    return (one - zero) * source.magnitude * scale, zero
