"""The kind of a unit: time, length, force, angle, torque, counts."""

import re
from typing import Literal

from tsas_cli.recordings.guess.words import NamedQuantity, words_of
from tsas_cli.recordings.units import conversion, is_label, is_unit
from tsas_cli.support.errors import InputError

UnitKind = Literal[
    "time", "length", "force", "angle", "torque", "rotation", "temperature", "label", "other"
]

# Kind, canonical unit, and the radius that converts an angle or a torque to it.
_TARGETS: tuple[tuple[UnitKind, str, float | None], ...] = (
    ("time", "s", None),
    ("length", "mm", None),
    ("force", "N", None),
    ("angle", "mm", 1.0),
    ("torque", "N", 1.0),
    ("rotation", "rpm", None),
    ("temperature", "°C", None),
)
QUANTITY_OF: dict[UnitKind, NamedQuantity] = {
    "time": "time",
    "length": "displacement",
    "force": "force",
    "angle": "angle",
    "torque": "torque",
    "rotation": "speed",
    "temperature": "temperature",
    "other": "other",
}
_FITTING: dict[NamedQuantity, tuple[UnitKind, ...]] = {
    "time": ("time",),
    "counter": ("label",),
    "displacement": ("length", "angle", "label"),
    "angle": ("angle", "length", "label"),
    "force": ("force", "torque", "label"),
    "torque": ("torque", "force", "label"),
    "speed": ("rotation", "label"),
    "temperature": ("temperature", "label"),
    "other": (),
}
# After a name without brackets: time_ms, Force N. `in`, `m`, `g` and `A` are left out, because they
# denote ends, masters and sensors as often as units.
_SUFFIXES = (
    "s ms us µs ns sec mm cm µm um inch N kN mN lbf kgf kg lbs Nm Nmm mNm deg ° rad rev rpm degC "
    "°C counts cts ticks V mV"
)
_SUFFIX = re.compile(r"^(.+?)[_\s.,/-]+([A-Za-zµ°]+)$")


def kind_of(unit: str) -> UnitKind | None:
    """Return the kind of a unit; "other" for one of no channel, None for text that is no unit."""
    if is_label(unit):
        return "label"
    for kind, to, radius in _TARGETS:
        try:
            conversion(unit, to, pulley_radius_mm=radius)
        except InputError:
            continue
        return kind
    return "other" if is_unit(unit) else None


def fits(quantity: NamedQuantity, kind: UnitKind) -> bool:
    """Return whether a quantity can have a unit of this kind."""
    return kind in _FITTING[quantity]


def unit_behind(name: str) -> tuple[str, str]:
    """Return a name without the unit at its end, and the unit; empty text without one."""
    found = _SUFFIX.match(name.strip())
    if found is None or found[2] not in _SUFFIXES.split():
        return name, ""
    stem, unit = found[1], found[2]
    kind, words = kind_of(unit), words_of(stem)
    if kind is None or (len(unit) == 1 and words.quantity is None and unit != "N"):
        return name, ""
    return (stem, unit) if words.quantity is None or fits(words.quantity, kind) else (name, "")
