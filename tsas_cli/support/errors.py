"""The error for an invalid call or invalid input."""

import re
from collections.abc import Iterable
from difflib import get_close_matches

from tsas_cli.support.wording import quoted

LONGEST_WORD = 200  # characters, in a message
NO_MEMORY = (
    "this needs more memory than is free; "
    "use a larger machine, fewer runs at a time (--runs), or shorter recordings"
)


class InputError(Exception):
    """An invalid call or invalid input: one line with fault, location, expectation and remedy.

    Parameters
    ----------
    what
        The fault, with the value found ("column f_in_N holds text").
    where
        File, and row or key where known ("runs/a.parquet, row 12").
    expected
        The expected value ("a number in newton").
    remedy
        What to do ("run `tsas check DATASET`").
    """

    def __init__(
        self, what: str, *, where: object = "", expected: str = "", remedy: str = ""
    ) -> None:
        self.what, self.where, self.expected, self.remedy = what, str(where), expected, remedy
        super().__init__(self.line())

    def __str__(self) -> str:
        return self.line()

    def line(self) -> str:
        """Return the whole message on one line, with control characters escaped."""
        expected = f"expected {self.expected}" if self.expected else ""
        more = filter(None, (expected, self.remedy))
        line = "; ".join(map(shortened, (self.what, *more)))
        return printable(f"{self.where}: {line}" if self.where else line)


def shortened(text: str) -> str:
    """Return text whose words without end, which someone has given, are cut.

    >>> shortened(f"there is no run {400 * 'b'}") == f"there is no run {LONGEST_WORD * 'b'}…"
    True
    """
    return re.sub(rf"(\S{{{LONGEST_WORD}}})\S+", r"\1…", text)


def printable(text: str) -> str:
    """Return text with control characters escaped, for names from files."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a hint with the nearest known name, or a list of the known names.

    >>> nearest("preload_n", ["preload_N", "load"])
    'did you mean preload_N?'
    >>> nearest("frictoin", ["fit_own", "friction_coefficient"])
    'did you mean friction_coefficient?'
    """
    known, name = [quoted(one) for one in known], str(name)
    begins = {other[: len(name)]: other for other in reversed(known)}  # of a name that is cut short
    close = get_close_matches(name, begins, n=1, cutoff=0.8) if len(name) > 3 else []
    found = get_close_matches(name, [*known, *close], n=1, cutoff=0.6)
    if found:
        return f"did you mean {begins.get(found[0], found[0])}?"
    return f"known are {', '.join(known)}" if known else "none are known here"
