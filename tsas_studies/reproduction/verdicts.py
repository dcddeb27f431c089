"""Rows whose verdict follows from the numbers and a tolerance that is said.

`because` is the cause where the numbers do not agree, and is dropped where they do.
"""

from collections.abc import Mapping

from tsas_cli.paper import Printed
from tsas_studies.reproduction.group import Row, Verdict

NOT_KNOWN = "of a cause that is not known here"


def to_the_digit(what: str, printed: Printed, ours: float, **said: str) -> Row:
    """Compare with a printed number as far as its digits go; `said`: `because`, `evidence`."""
    half = f"{printed.half_a_digit:.12f}".rstrip("0").rstrip(".")
    near = abs(ours - printed.value) <= printed.half_a_digit * (1.0 + 1e-9)
    return _beside(what, printed, ours, near, f"to the last digit printed, ± {half}", said)


def within(what: str, printed: Printed, ours: float, *, percent: float, **said: str) -> Row:
    """Compare with a printed number, to some percent of it; `said`: `because`, `evidence`."""
    near = abs(ours - printed.value) <= 1e-2 * percent * abs(printed.value)
    return _beside(what, printed, ours, near, f"within {percent:g} %", said)


def _beside(
    what: str, printed: Printed, ours: float, near: bool, criterion: str, said: Mapping[str, str]
) -> Row:
    return holds(
        what,
        printed.source,
        true=near,
        criterion=criterion,
        unit=printed.unit,
        paper=printed.value,
        ours=ours,
        **said,
    )


def holds(
    what: str,
    source: str,
    *,
    true: bool,
    criterion: str,
    unit: str = "",
    paper: float | None = None,
    ours: float | None = None,
    because: str = "",
    evidence: str = "",
) -> Row:
    """Judge a statement of the paper; `criterion` says in words when `true` is."""
    verdict: Verdict = "agrees" if true else "differs"
    cause = "" if true else because or NOT_KNOWN
    return Row(what, source, unit, paper, ours, verdict, criterion, cause, evidence)


def undetermined(
    what: str,
    source: str,
    *,
    because: str,
    evidence: str = "",
    unit: str = "",
    ours: float | None = None,
) -> Row:
    """Say that a number cannot be computed, or has nothing to be held against."""
    return Row(what, source, unit, None, ours, "cannot tell", "", because, evidence)


def signed(value: float, decimals: int) -> str:
    """Return a number with its sign, for a sentence."""
    return f"{value:+.{decimals}f}".replace("-", "−")
