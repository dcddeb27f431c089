"""What the words in a column's name speak of: a quantity, an end of the tendon, a wish."""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeVar

Quantity = Literal[
    "time", "counter", "displacement", "angle", "force", "torque", "speed", "temperature", "other"
]
Place = Literal["in", "out", "motor"]
M = TypeVar("M", Quantity, Place)

# Whole words. Words of five letters and more also count as the beginning or the end of a longer
# one (Eingangskraft, displacement1).
_QUANTITIES: dict[Quantity, str] = {
    "time": "time t zeit temps timestamp tijd tiempo elapsed clock sec seconds sekunden "
    "secondes 时间",
    "counter": "sample samples index idx count row nr no messpunkt 序号",
    "displacement": "x s displacement disp displ position pos travel stroke encoder enc lvdt "
    "crosshead extension verschiebung auslenkung hub weg pfad deplacement course excursion "
    "laser 位移 行程",
    "angle": "angle winkel theta phi rotation turntable rotary drehwinkel 角度 转角",
    "force": "f force tension loadcell cell kraft zugkraft seilkraft effort dynamometer "
    "tendonforce 力 张力 拉力",
    "torque": "torque moment drehmoment tau couple 力矩 扭矩",
    "speed": "speed rpm omega velocity vel drehzahl geschwindigkeit vitesse acceleration 速度 转速",
    "temperature": "temp temperature temperatur 温度",
    "other": "current strom courant amps power leistung pwm duty pressure "
    "strain friction error pulse flag status mode trigger 电流",
}
_PLACES: dict[Place, str] = {
    "in": "in input inlet ein proximal prox drive driving driven actuator actuation master backend "
    "winch spool turntable eingang antrieb antriebsseite entree amont proximale 输入 近端 驱动",
    "out": "out output outlet aus distal distale tip slave effector endeffector frontend ausgang "
    "abtrieb abtriebsseite lastseite sortie aval 输出 远端 末端",
    "motor": "motor moteur servo 电机",
}
WEAK = frozenset({"load", "last", "charge", "dist", "end", "负载"})  # an end only beside a quantity
_WISHES = (
    "ref reference desired target setpoint set soll sollwert wanted cmd command commanded "
    "demand trajectory goal consigne 期望 参考"
)
_BEFORE_END = "f x s t d q force pos disp tension kraft weg"  # fin, xout, posin: one word of two
_ENDS = {"in": "in", "out": "out", "prox": "in", "dist": "out", "ref": "ref", "des": "ref"}
_LONG = 5


@dataclass(frozen=True)
class Words:
    """What a name says; `told` holds the word that each of it comes from."""

    quantity: Quantity | None
    place: Place | None
    wish: bool
    told: dict[str, str] = field(default_factory=dict)


def words_of(name: str) -> Words:
    """Return what a column's name says, without its unit.

    Where words speak of several quantities the first in the order of `_FIRST` counts; where they
    speak of both ends, of none.
    """
    parts = _parts(name)
    quantities = _told(parts, _QUANTITIES)
    places = _told(parts, _PLACES)
    if "t" in parts and len(parts) > 1 and places:
        quantities = {k: v for k, v in quantities.items() if v != "t"} | {"force": "t"}
    weak = next((p for p in parts if p in WEAK), None)
    if weak and not places and (quantities or weak not in ("end", "dist")):
        places["out"] = weak
    place = _place(places)
    quantity = next((q for q in _FIRST if q in quantities), None)
    wish = next((p for p in parts if p in _WISHES.split()), None)
    told = {"quantity": quantities[quantity]} if quantity else {}
    told |= {"place": places[place]} if place else {}
    told |= {"wish": wish} if wish else {}
    return Words(quantity, place, wish is not None, told)


# "motor current", "force error": what is special comes before what is general.
_FIRST: tuple[Quantity, ...] = (
    "other", "temperature", "speed", "torque", "force", "angle", "displacement", "counter", "time",
)  # fmt: skip


def _place(places: dict[Place, str]) -> Place | None:
    if "motor" in places:
        return "motor"
    return next(iter(places)) if len(places) == 1 else None


def _told(parts: list[str], vocabulary: Mapping[M, str]) -> dict[M, str]:
    found: dict[M, str] = {}
    whole = {word for listed in vocabulary.values() for word in listed.split()}
    for meaning, listed in vocabulary.items():
        for part in parts:
            if any(_is(part, word, whole=part in whole) for word in listed.split()):
                found.setdefault(meaning, part)
    return found


def _is(part: str, word: str, *, whole: bool) -> bool:
    """Say whether a part of a name is a word, or, where it is none itself, holds a long one."""
    if whole or part == word:
        return part == word
    if not word.isascii():
        return word in part
    return len(word) >= _LONG and (part.startswith(word) or part.endswith(word))


def _parts(name: str) -> list[str]:
    """Return the words of a name in small letters, split at signs, capitals and numbers."""
    plain = "".join(c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", plain)
    plain = re.sub(r"(?i)\b(load|back|front|end)[\s_-]?(cell|end|effector)", r"\1\2", plain)
    parts = re.findall(r"[^\W\d_]+", plain.lower())
    return [word for part in parts for word in _split(part)]


def _split(part: str) -> list[str]:
    """Split fin, xout, posref into their two words."""
    for end, meaning in _ENDS.items():
        head = part.removesuffix(end)
        if head != part and head in _BEFORE_END.split():
            return [head, meaning]
    return [part]
