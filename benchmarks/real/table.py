"""The table of docs/measured.md, in which each split has the lines of its last run."""

from collections.abc import Sequence

from benchmarks.real.learning import Learned
from benchmarks.real.splits import Split

BEGIN, END = "<!-- make real -->", "<!-- until here -->"
COLUMNS = ("nominal", "extended", "ridge", "published", "repeatability")
HEADER = (f"| split | channel | {' | '.join(COLUMNS)} |", "|---|---|---|---|---|---|---|")
MOST_SHOWN = 4  # runs, one by one; of more, the mean and the range


def lines_of(split: Split, it: Learned) -> list[str]:
    """Return a split's rows of the table, and what its diagnosis says."""
    lines = []
    for channel, errors in it.errors.items():
        cells = {name: _shown(values) for name, values in errors.items()}
        cells["published"] = split.said.get("published", {}).get(channel, "")
        row = [split.name, channel, *(cells.get(name, "") for name in COLUMNS)]
        lines.append(f"| {' | '.join(row)} |")
    return [*lines, f"- {split.name}: `{it.verdict}`. {it.reason}"]


def with_lines(page: str, name: str, new: Sequence[str], order: Sequence[str]) -> str:
    """Return a page whose table has the lines of one split anew, in the order of all splits."""
    before, rest = page.split(BEGIN)
    table, after = rest.split(END)
    signs = {one: (f"| {one} |", f"- {one}:") for one in order}
    kept = {one: [t for t in table.splitlines() if t.startswith(of)] for one, of in signs.items()}
    lines = [line for of in (kept | {name: new}).values() for line in of]
    rows, said = ([line for line in lines if line.startswith(sign)] for sign in "|-")
    return "\n".join((f"{before}{BEGIN}", *HEADER, *rows, "", *said, f"{END}{after}"))


def _shown(values: Sequence[float | None]) -> str:
    known = [v for v in values if v is not None]
    if len(known) <= MOST_SHOWN:
        return " / ".join(map(_text, known))
    return f"{_text(sum(known) / len(known))} ({_text(min(known))} to {_text(max(known))})"


def _text(value: float) -> str:
    return f"{float(f'{value:.3g}'):g}"  # 1510, not 1.51e+03
