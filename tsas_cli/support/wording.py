"""Wording that messages share."""

from collections.abc import Sequence

SOME = 3


def count_of(number: int, noun: str) -> str:
    """Return a number with its noun, in the plural unless it is one."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def quoted(name: str) -> str:
    """Return a name as an option takes it in a list of several.

    >>> [quoted(name) for name in ("a", "a,b")]
    ['a', '"a,b"']
    """
    return f'"{name}"' if "," in name else name


def some_of(words: Sequence[str]) -> list[str]:
    """Return the first words and how many more there are, if they are many.

    >>> some_of(["time", "speed", "run", "phase", "place"])
    ['time', 'speed', 'run', '2 more']
    """
    more = len(words) - SOME
    return [*words[:SOME], f"{more} more"] if more > 1 else list(words)


def listed(words: Sequence[str], last: str = " and ") -> str:
    """Return words as a person lists them.

    >>> listed(["time", "speed", "run"])
    'time, speed and run'
    """
    return last.join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
