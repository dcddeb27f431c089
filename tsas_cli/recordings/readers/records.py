"""Records that hold records or lists, as flat ones: the messages of robots, lines of JSON."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any

import numpy as np

_MOST_ITEMS = 64  # of a list, whose items become columns; longer ones are images or scans


def flat(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of a record by their paths: `pose.position.x`, `effort[0]`."""
    for key, value in record.items():
        yield from _named(f"{prefix}{key}", value)


def _named(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if is_dataclass(value):
        value = vars(value)
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.size <= _MOST_ITEMS else []
    if isinstance(value, Mapping):
        yield from flat(value, f"{name}.")
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        for i, item in enumerate(value if len(value) <= _MOST_ITEMS else ()):
            yield from _named(f"{name}[{i}]", item)
    else:
        yield name, value
