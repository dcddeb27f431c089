"""From the units of a lab to the units of the canonical columns."""

import math
import re
from functools import cache
from typing import Any

from tsas_cli.support.errors import InputError

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
    "Grad": "degree",  # German; pint takes it for gon
    "N-m": "N*m",
    "N-mm": "N*mm",
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
_LABELS = {
    "count",
    "counts",
    "cts",
    "pulse",
    "pulses",
    "tick",
    "ticks",
    "inc",
    "px",
    "pixel",
    "pixels",
    "v",
    "mv",
    "volt",
    "volts",
}
_TORQUE = re.compile(r"([mkM]?N)(mm|cm|m)")
_CAPITALISED = re.compile(r"[A-Z][a-z]{3,}")
_LONGEST = 100  # characters of a unit
# What a unit is written with. pint drops every other character, which makes metres of `?m`.
_SPELT = re.compile(r"%|(?:[A-Za-zÅ\u212båöµμΩ\u2126°0-9*/^·().+_ -]|⁻?[²³⁴]|⁻¹)*")
_TIMES = str.maketrans(dict.fromkeys("⋅×•∙", "*"))
_NUMBER_AHEAD = re.compile(r"(?!1 ?/)[0-9.]")  # 1/min is a unit, 1m is not
# On the web, in the sky and in an army: a pixel of a camera, an arbitrary unit, 0.001 inch here.
_OF_NO_LAB = ("css_pixel", "astronomical_unit", "mil")
_POWER_OF_A_NUMBER = re.compile(r"[\d)]\s*\*\*")  # 9**9**9**9 would be worked out digit by digit
_KINDS = {
    "s": "a time",
    "mm": "a length",
    "N": "a force",
    "N*mm": "a torque",
    "rad": "an angle",
    "rpm": "a speed of rotation, such as rpm, turn/s or rad/s",
    "°C": "a temperature",
}


def conversion(
    unit: str,
    to: str,
    *,
    factor: float | None = None,
    factor_unit: str | None = None,
    pulley_radius_mm: float | None = None,
    where: str = "",
) -> tuple[float, float]:
    """Return slope and intercept that take a number in a file to a canonical unit.

    Parameters
    ----------
    unit
        The unit as people write it.
    to
        The canonical unit: s, mm, N, rpm, rad or °C.
    factor, factor_unit
        What one `unit` is, needed for counts and volts: `factor` times `factor_unit`.
    pulley_radius_mm
        The radius on which an angle becomes mm, or a torque N.
    where
        The place that errors name.

    Raises
    ------
    InputError
        The unit is unknown, or cannot become the canonical one; says what to add. One of it is no
        finite number of the canonical one, or none.
    """
    if factor is None and is_label(unit):
        raise InputError(
            f"unit {unit!r} does not say how many {to} one is",
            where=where,
            remedy="say what one is with factor and factor_unit",
        )
    scale = 1.0 if factor is None else factor
    text = factor_unit or unit
    if pulley_radius_mm is None:
        slope, intercept = _between(text, to, where)
        slope *= scale
    elif to == "mm":
        slope, intercept = _between(text, "rad", where)[0] * scale * pulley_radius_mm, 0.0
    elif to == "N":
        slope, intercept = _between(text, "N*mm", where)[0] * scale / pulley_radius_mm, 0.0
    else:
        raise InputError(
            f"pulley_radius_mm does not apply to {to}",
            where=where,
            expected="a column in mm from an angle, or in N from a torque",
        )
    if slope == 0.0 or not math.isfinite(slope):
        raise InputError(f"one {unit} is {slope:g} {to}", where=where, expected="not 0, finite")
    return slope, intercept


def is_label(unit: str) -> bool:
    """Say whether a unit is one of counts or volts, which need a factor."""
    return unit.strip().lower() in _LABELS


def is_unit(text: str) -> bool:
    """Say whether text is a unit at all."""
    try:
        return not _parse(text, "", "").dimensionless
    except InputError:
        return False


def _between(text: str, to: str, where: str) -> tuple[float, float]:
    if text.strip() == to:  # without pint, which takes longer to load than to read a recording
        return 1.0, 0.0
    unit, wanted = _parse(text, to, where), _parse(to, to, where)
    line = _line(unit, wanted) if _roots(unit) == _roots(wanted) else None
    if line is None:
        raise InputError(
            f"unit {text!r} cannot become {to}",
            where=where,
            expected=_KINDS[to],
            remedy=_remedy(unit, to),
        )
    return line


def _line(unit: Any, wanted: Any) -> tuple[float, float] | None:
    """Return slope and intercept, or None where there are none (differences of temperatures)."""
    try:
        zero, one = (float(_registry().Quantity(x, unit).to(wanted).magnitude) for x in (0.0, 1.0))
    except (ArithmeticError, TypeError, ValueError):  # pint's DimensionalityError is a TypeError
        return None
    slope = one - zero
    return (slope, zero) if math.isfinite(slope) and slope != 0.0 else None


def _parse(text: str, to: str, where: str) -> Any:
    spelled = " ".join(text.translate(_TIMES).split())
    spelled = _SPELLINGS.get(spelled, spelled)
    if to == "N":
        spelled = _AS_FORCE.get(spelled, spelled)
    if to == "°C":
        spelled = _AS_TEMPERATURE.get(spelled, spelled)
    spelled = _CAPITALISED.sub(lambda word: word[0].lower(), spelled)
    if torque := _TORQUE.fullmatch(spelled):
        spelled = f"{torque[1]}*{torque[2]}"
    try:
        return _unit(spelled)
    except Exception as error:  # pint's parser ends in any of a dozen types
        raise InputError(
            f"unit {text!r} is unknown", where=where, expected=_KINDS.get(to, "")
        ) from error


def _unit(text: str) -> Any:
    from pint.util import string_preprocessor

    if not _SPELT.fullmatch(text) or _NUMBER_AHEAD.match(text) or len(text) > _LONGEST:
        raise ValueError(text)
    if _POWER_OF_A_NUMBER.search(string_preprocessor(text)):
        raise ValueError(text)
    unit = _registry().Unit(text)
    _roots(unit)  # there are none of what pint has made a name for and does not know: Np%
    if any(name.endswith(_OF_NO_LAB) for name, _ in _registry().Quantity(1, unit).unit_items()):
        raise ValueError(text)
    return unit


def _roots(unit: Any) -> Any:
    """Return what a unit is made of; unlike dimensions, this tells mm/deg from mm, 1/s from rpm."""
    return _registry().get_root_units(unit)[1]


def _remedy(unit: Any, to: str) -> str:
    if to == "mm" and _roots(unit) == _registry().Unit("rad"):
        return "an angle needs pulley_radius_mm to become mm"
    if to == "N" and _roots(unit) == _roots(_registry().Unit("N*mm")):
        return "a torque needs pulley_radius_mm to become N"
    return "is this the right source column, and its unit the one in the file?"


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()
