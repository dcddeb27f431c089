"""The meaning of a column's name: quantity, end of the tendon, reference, kind of its unit."""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeVar

from tsas_cli.recordings.units import conversion, is_label, is_unit
from tsas_cli.support.errors import InputError

NamedQuantity = Literal[
    "time", "counter", "displacement", "angle", "force", "torque", "speed", "temperature", "other"
]
End = Literal["in", "out", "motor"]
Meaning = TypeVar("Meaning", NamedQuantity, End)

# Whole words. Words of five letters and more also count as the beginning or the end of a longer
# one (Eingangskraft, displacement1).
_QUANTITIES: dict[NamedQuantity, str] = {
    "time": "time t zeit temps timestamp tijd tiempo elapsed clock sec seconds sekunden "
    "secondes xvalue 时间",
    "counter": "sample samples index idx count row nr no messpunkt 序号",
    "displacement": "x s displacement disp displ position pos travel stroke encoder enc lvdt "
    "crosshead extension verschiebung auslenkung hub weg pfad deplacement course excursion "
    "laser 位移 行程",
    "angle": "angle winkel theta phi orientation rotation turntable rotary drehwinkel 角度 转角",
    "force": "f force tension loadcell cell kraft zugkraft seilkraft effort dynamometer "
    "tendonforce 力 张力 拉力",
    "torque": "torque moment drehmoment tau couple 力矩 扭矩",
    "speed": "speed rpm omega velocity vel drehzahl geschwindigkeit vitesse acceleration 速度 转速",
    "temperature": "temp temperature temperatur 温度",
    "other": "current strom courant amps power leistung pwm duty pressure "
    "strain friction error pulse flag status mode trigger 电流",
}
_END_WORDS: dict[End, str] = {
    "in": "in input inlet ein proximal prox drive driving driven actuator actuation master backend "
    "winch spool turntable eingang antrieb antriebsseite entree amont proximale 输入 近端 驱动",
    "out": "out output outlet aus distal distale tip slave effector endeffector frontend ausgang "
    "abtrieb abtriebsseite lastseite sortie aval 输出 远端 末端",
    "motor": "motor moteur servo 电机",
}
# They mean an end only with a quantity.
WEAK = frozenset({"load", "last", "charge", "dist", "end", "负载"})
_REFERENCES = (
    "ref reference desired target setpoint set soll sollwert wanted cmd command commanded "
    "demand trajectory goal consigne 期望 参考"
)
_BEFORE_END = "f x s t d q force pos disp tension kraft weg"  # fin, xout, posin: compounds
_ENDS = {"in": "in", "out": "out", "prox": "in", "dist": "out", "ref": "ref", "des": "ref"}
_LONG = 5


@dataclass(frozen=True)
class Words:
    """The meaning of a name; `matched` holds the word behind each part of it."""

    quantity: NamedQuantity | None
    end: End | None
    is_reference: bool
    matched: dict[str, str] = field(default_factory=dict)


def words_of(name: str) -> Words:
    """Return the meaning of a column's name without its unit.

    Of several quantities, the first in `_PRIORITY` counts; of two contradictory ends, neither.
    """
    parts = _parts(name)
    quantities = _matches(parts, _QUANTITIES)
    ends = _matches(parts, _END_WORDS)
    if "t" in parts and len(parts) > 1 and ends:
        quantities = {k: v for k, v in quantities.items() if v != "t"} | {"force": "t"}
    weak = next((p for p in parts if p in WEAK), None)
    if weak and not ends and (quantities or weak not in ("end", "dist")):
        ends["out"] = weak
    end: End | None = next(iter(ends)) if len(ends) == 1 else None
    end = "motor" if "motor" in ends else end
    quantity = next((q for q in _PRIORITY if q in quantities), None)
    reference = next((p for p in parts if p in _REFERENCES.split()), None)
    matched = {"quantity": quantities[quantity]} if quantity else {}
    matched |= {"end": ends[end]} if end else {}
    matched |= {"reference": reference} if reference else {}
    return Words(quantity, end, reference is not None, matched)


# "motor current", "force error": the specific before the general.
_PRIORITY: tuple[NamedQuantity, ...] = (
    "other", "temperature", "speed", "torque", "force", "angle", "displacement", "counter", "time",
)  # fmt: skip


def _matches(parts: list[str], vocabulary: Mapping[Meaning, str]) -> dict[Meaning, str]:
    """Return the meanings of the parts of a name, each with its first matching part."""
    found: dict[Meaning, str] = {}
    whole = {word for listed in vocabulary.values() for word in listed.split()}
    for meaning, listed in vocabulary.items():
        for part in parts:
            if any(_is(part, word, whole=part in whole) for word in listed.split()):
                found.setdefault(meaning, part)
    return found


def _is(part: str, word: str, *, whole: bool) -> bool:
    """Return whether a part of a name is a word, or contains a long one if it is none itself."""
    if whole or part == word:
        return part == word
    if not word.isascii():
        return word in part
    return len(word) >= _LONG and (part.startswith(word) or part.endswith(word))


def _parts(name: str) -> list[str]:
    """Return the words of a name in lower case, split at signs, capitals and numbers."""
    plain = "".join(c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", plain)
    plain = re.sub(r"(?i)\b(load|back|front|end)[\s_-]?(cell|end|effector)", r"\1\2", plain)
    plain = re.sub(r"(?i)\bx_value\b", "xvalue", plain)  # of LabVIEW
    words = []
    for part in re.findall(r"[^\W\d_]+", plain.lower()):
        compounds = (  # fin, xout, posref
            [head, meaning]
            for end, meaning in _ENDS.items()
            if (head := part.removesuffix(end)) != part and head in _BEFORE_END.split()
        )
        words += next(compounds, [part])
    return words


UnitKind = NamedQuantity | Literal["label"]  # a label is of counts or volts

# Quantity of a unit, canonical unit, and the radius that converts an angle or a torque to it.
_TARGETS: tuple[tuple[UnitKind, str, float | None], ...] = (
    ("time", "s", None),
    ("displacement", "mm", None),
    ("force", "N", None),
    ("angle", "mm", 1.0),
    ("torque", "N", 1.0),
    ("speed", "rpm", None),
    ("temperature", "°C", None),
)
_RELATED = {"displacement": "angle", "angle": "displacement", "force": "torque", "torque": "force"}
# After a name without brackets: time_ms, Force N. `in`, `m`, `g` and `A` are left out, because they
# denote ends, masters and sensors as often as units.
_SUFFIXES = (
    "s ms us µs ns sec mm cm µm um inch N kN mN lbf kgf kg lbs Nm Nmm mNm deg ° rad rev rpm degC "
    "°C counts cts ticks V mV"
)
_SUFFIX = re.compile(r"^(.+?)[_\s.,/-]+([A-Za-zµ°]+)$")


def kind_of(unit: str) -> UnitKind | None:
    """Return the quantity of a unit; "other" for one of no channel, None for text that is none."""
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
    if quantity == "other" or kind == "label":
        return quantity not in ("other", "time")
    return kind in (quantity, _RELATED.get(quantity))


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
