"""Changes a TOML or JSON document at a random place, so that it stays one most of the time."""

import json
import math
import random
import tomllib
from collections.abc import Callable
from functools import reduce
from typing import Any

Change = Callable[[bytes, int, int], bytes]
ODD: tuple[Any, ...] = (
    "", "?", "..", "/", "../a", "a/b", "\x1b[2J", "\u202e", "é" * 300, "{stem}", "first", "0" * 64,
    0, 1, -1, 2**31, -(2**63), 10**30, 10**400, 0.0, -0.0, 1e-320, 1e308, math.inf, math.nan,
    True, False, None, [], {}, [[]], [{}], [1, "a"], {"": {}}, {"a": {"b": [1]}},
    reduce(lambda inner, _: [inner], range(400), 1),
    reduce(lambda inner, _: {"a": inner}, range(400), {}),
)  # fmt: skip


def toml_document(data: bytes, most: int, seed: int) -> bytes:
    """Change a TOML document, or its bytes."""
    return _changed(data, most, seed, tomllib.loads, _toml)


def json_document(data: bytes, most: int, seed: int) -> bytes:
    """Change a JSON document, or its bytes."""
    return _changed(data, most, seed, json.loads, json.dumps)


def after_a_byte(change: Change) -> Change:
    """Change what stands behind a first byte, which chooses something."""

    def changed(data: bytes, most: int, seed: int) -> bytes:
        first = data[:1] or b"\0"
        if seed % 16 == 0:
            first = bytes([seed // 16 % 256])
        return first + change(data[1:], most - 1, seed)

    return changed


def _changed(
    data: bytes, most: int, seed: int, read: Callable[[str], Any], write: Callable[[Any], str]
) -> bytes:
    from atheris import Mutate

    chance = random.Random(seed)  # noqa: S311 # not a secret
    if chance.random() < 0.3:
        return bytes(Mutate(data, most))
    try:
        content = read(data.decode())
        for _ in range(chance.choice((1, 1, 2, 4))):
            content = _with_a_change(content, chance)
        return write(content).encode("utf-8", "surrogatepass")[:most]
    except (ValueError, TypeError, LookupError, ArithmeticError, RecursionError):
        return bytes(Mutate(data, most))


def _toml(content: Any) -> str:
    """Return TOML with all tables inline, several times as fast as a library that keeps layouts."""
    items = content.items() if isinstance(content, dict) else [("a", content)]
    return "\n".join(f"{_text(key)} = {_value(value)}" for key, value in items)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        return _text(value)
    return str(value).lower()


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _with_a_change(content: Any, chance: random.Random) -> Any:
    """Return the content with one value changed, taken away, doubled or put elsewhere."""
    places = list(_places(content))
    if not places:
        return chance.choice(ODD)
    holder, key = chance.choice(places)
    kind = chance.randrange(6)
    if kind == 0:
        del holder[key]
    elif kind == 1:
        other, name = chance.choice(places)
        holder[key] = json.loads(json.dumps(other[name], default=str)) if name in other else 0
    elif kind == 2 and isinstance(holder, list):
        holder.insert(key, holder[key])
    elif kind == 2:
        holder[_odd_name(str(key), chance)] = holder.pop(key)
    elif kind == 3 and isinstance(holder[key], int | float) and not isinstance(holder[key], bool):
        holder[key] *= chance.choice((-1, 0.5, 10, 1000, 1e-6, 1e6))
    elif kind == 3 and isinstance(holder[key], str):
        at = chance.randrange(len(holder[key]) + 1)
        holder[key] = holder[key][:at] + str(chance.choice(ODD)) + holder[key][at:]
    else:
        holder[key] = chance.choice(ODD)
    return content


def _odd_name(name: str, chance: random.Random) -> str:
    return chance.choice(
        (name + "x", name[:-1], "", "\x1b]0;a\x07", "a.b", "..", "é", name.upper())
    )


def _places(content: Any) -> Any:
    if isinstance(content, dict):
        items: Any = list(content.items())
    elif isinstance(content, list):
        items = list(enumerate(content))
    else:
        return
    for key, value in items:
        yield content, key
        yield from _places(value)
