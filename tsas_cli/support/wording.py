"""Wording that messages share."""

from collections.abc import Sequence


def count_of(number: int, noun: str) -> str:
    """Return a number with its noun, in the plural unless it is one."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def quoted(name: str) -> str:
    """Return a name as an option takes it in a list of several.

    >>> [quoted(name) for name in ("a", "a,b")]
    ['a', '"a,b"']
    """
    return f'"{name}"' if "," in name else name


def listed(words: Sequence[str], last: str = " and ") -> str:
    """Return words as a person lists them.

    >>> listed(["time", "speed", "run"])
    'time, speed and run'
    """
    return last.join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
