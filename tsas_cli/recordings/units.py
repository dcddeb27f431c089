"""Conversion of units in lab notation to those of the canonical columns."""

import math
import re
from contextlib import suppress
from functools import cache
from typing import Any

from tsas_cli.support.errors import InputError

# Spellings in header lines that pint rejects or misreads: it reads `Nm` as number-metre, `1/min`
# as radians per minute and `U` as an enzyme unit.
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
    "Grad": "degree",  # German; pint reads it as gon
}
_AS_FORCE = {"lb": "lbf", "lbs": "lbf", "kg": "kgf", "g": "gf", "oz": "ozf", "kp": "kgf"}
_AS_TEMPERATURE = {"C": "degC", "F": "degF"}
_LABEL = re.compile(r"counts?|cts|pulses?|ticks?|inc|px|pixels?|m?v|volts?")
_TORQUE = re.compile(r"([mkM]?N)-?(mm|cm|m)")
_POUND_INCH = re.compile(r"(in|ft)-lbf?|lbf?-(in|ft)")
_CAPITALISED = re.compile(r"[A-Z][a-z]{3,}")
_UNIT_LENGTH = 100  # characters of a unit
# Valid characters of a unit. pint drops all others, which turns `?m` into metre.
_VALID = re.compile(r"%|(?:[A-Za-zÅ\u212båöµμΩ\u2126°0-9*/^·().+_ -]|⁻?[²³⁴]|⁻¹)*")
_TIMES = str.maketrans(dict.fromkeys("⋅×•∙", "*"))
_NUMBER_AHEAD = re.compile(r"(?!1 ?/)[0-9.]")  # 1/min is a unit, 1m is not
# pint's meanings of px, au and mil; in a lab: a camera's pixel, an arbitrary unit, 0.001 inch.
_AMBIGUOUS = ("css_pixel", "astronomical_unit", "mil")
_POWER_OF_A_NUMBER = re.compile(r"[\d)]\s*\*\*")  # 9**9**9**9 would be evaluated digit by digit
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
    """Return slope and intercept of the conversion of a number in a file to a canonical unit.

    `unit` has any common spelling, `to` is s, mm, N, rpm, rad or °C. One `unit` is `factor` times
    `factor_unit`, which counts and volts need; `pulley_radius_mm` converts an angle to mm, or a
    torque to N; `where` is the location in error messages.

    InputError: the unit is unknown or not convertible, or the factor is zero or not finite.
    """
    if factor is None and is_label(unit):
        raise InputError(
            f"unit {unit!r} has no defined size in {to}",
            where=where,
            remedy="set factor and factor_unit",
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
    """Return whether a unit is one of counts or volts, which need a factor."""
    return _LABEL.fullmatch(unit.strip().lower()) is not None


def is_unit(text: str) -> bool:
    """Return whether text is a unit with a dimension."""
    try:
        return not _parse(text, "", "").dimensionless
    except InputError:
        return False


def _between(text: str, to: str, where: str) -> tuple[float, float]:
    if text.strip() == to:  # without pint, which takes longer to load than a recording
        return 1.0, 0.0
    unit, target = _parse(text, to, where), _parse(to, to, where)
    zero = slope = 0.0
    if _roots(unit) == _roots(target):
        with suppress(ArithmeticError, TypeError, ValueError):  # of a difference of temperatures
            number = _registry().Quantity
            zero, one = (float(number(x, unit).to(target).magnitude) for x in (0.0, 1.0))
            slope = one - zero
    if slope == 0.0 or not math.isfinite(slope):
        remedy = "check the source column and its unit"
        if to == "mm" and _roots(unit) == _registry().Unit("rad"):
            remedy = "set pulley_radius_mm to convert an angle to mm"
        elif to == "N" and _roots(unit) == _roots(_registry().Unit("N*mm")):
            remedy = "set pulley_radius_mm to convert a torque to N"
        raise InputError(
            f"unit {text!r} is not convertible to {to}",
            where=where,
            expected=_KINDS[to],
            remedy=remedy,
        )
    return slope, zero


def _parse(text: str, to: str, where: str) -> Any:
    spelled = " ".join(text.translate(_TIMES).split())
    if spelled == "grad":
        raise InputError(
            "unit 'grad' is gon in English, degree in German", where=where, expected="deg or gon"
        )
    spelled = _SPELLINGS.get(spelled, spelled)
    if to == "N":
        spelled = _AS_FORCE.get(spelled, spelled)
    if to == "°C":
        spelled = _AS_TEMPERATURE.get(spelled, spelled)
    spelled = _CAPITALISED.sub(lambda word: word[0].lower(), spelled)
    if torque := _TORQUE.fullmatch(spelled):
        spelled = f"{torque[1]}*{torque[2]}"
    elif arm := _POUND_INCH.fullmatch(spelled):
        spelled = f"lbf*{arm[1] or arm[2]}"
    try:
        return _unit(spelled)
    except Exception as error:  # pint's parser raises any of a dozen types
        raise InputError(
            f"unit {text!r} is unknown", where=where, expected=_KINDS.get(to, "")
        ) from error


def _unit(text: str) -> Any:
    from pint.util import string_preprocessor

    if not _VALID.fullmatch(text) or _NUMBER_AHEAD.match(text) or len(text) > _UNIT_LENGTH:
        raise ValueError(text)
    if _POWER_OF_A_NUMBER.search(string_preprocessor(text)):
        raise ValueError(text)
    unit = _registry().Unit(text)
    _roots(unit)  # raises for names that pint accepts but does not define: Np%
    if any(name.endswith(_AMBIGUOUS) for name, _ in _registry().Quantity(1, unit).unit_items()):
        raise ValueError(text)
    return unit


def _roots(unit: Any) -> Any:
    """Return the base units; unlike dimensions, they distinguish mm/deg from mm, 1/s from rpm."""
    return _registry().get_root_units(unit)[1]


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()
