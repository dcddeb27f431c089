"""What people write for units, in maps and above columns."""

from tests.fuzz.rules import Broken, answer
from tsas_cli.recordings.columns import COLUMNS
from tsas_cli.recordings.guess.words import kind_of, unit_behind
from tsas_cli.recordings.units import _SPELLINGS, conversion, is_label, is_unit

SHARE = 7
OTHERS = ("mm", "newton", "kilogram_force", "**", "^", "²", "µ", "per")
WORDS = tuple(word.encode() for word in (*_SPELLINGS, "counts", "ticks", "px", "mV", *OTHERS))
MOST_BYTES = 60
CANONICAL = tuple(dict.fromkeys(column.unit for column in COLUMNS))


def one(data):
    """A slope is a finite number; the first byte chooses what to convert to."""
    text = data[1:].decode("utf-8", "replace")
    to = CANONICAL[data[0] % len(CANONICAL)] if data else "mm"
    factor = 2.0 if is_label(text) else None
    found = answer(conversion, text, to, factor=factor, factor_unit="N" if factor else None)
    if found is not None and not all(isinstance(x, float) for x in found):
        raise Broken(f"{text!r} is {found} {to}")
    answer(conversion, text, to, pulley_radius_mm=5.0)
    is_unit(text)
    unit_behind(text)
    answer(kind_of, text)


def seeds():
    for text in (*_SPELLINGS, "mm", "µm", "kN", "m/s**2", "N*m", "Nm", "°C", "degC", "delta_degC"):
        for to in range(0, len(CANONICAL), 2):
            yield bytes([to]) + text.encode()
