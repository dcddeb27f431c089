"""What got slower from one `make bench` to another, beyond noise: by ratios within each run."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json

FORMAT = 2
FLOOR = 0.1  # relative change that nobody minds
ONCE = 0.2  # relative noise of what was measured once
Table = tuple[str, list[str], list[list[str]]]


@dataclass(frozen=True)
class Change:
    """One row in both runs.

    `by` is how many times as long the work takes now, `noise` how far that may be from 1 with
    nothing changed: what the repeats of both runs and of their yardsticks show.
    """

    benchmark: str
    name: str
    kind: str
    old: float
    new: float
    by: float
    noise: float

    @property
    def verdict(self) -> str:
        """Say whether it got slower or faster, empty where that is within the noise."""
        limit = 1.0 + self.noise
        return "SLOWER" if self.by > limit else "faster" if self.by < 1.0 / limit else ""


@dataclass(frozen=True)
class Comparison:
    """What two runs say of each other: rows in both that are speeds, and rows in one alone."""

    changes: tuple[Change, ...]
    missing: tuple[str, ...]
    added: tuple[str, ...]

    @property
    def slower(self) -> tuple[Change, ...]:
        """What got slower beyond noise."""
        return tuple(change for change in self.changes if change.verdict == "SLOWER")

    def tables(self) -> list[Table]:
        """Return what changed; all else is a count."""
        told = sorted((c for c in self.changes if c.verdict), key=lambda c: -c.by)
        header = ["benchmark", "what", "old", "new", "in", "takes", "noise", "verdict"]
        rows = [
            [
                c.benchmark,
                c.name,
                f"{c.old:.4g}",
                f"{c.new:.4g}",
                "yardsticks" if c.kind in {"time", "rate"} else "",
                f"{c.by:.2f} times",
                f"± {100.0 * c.noise:.0f} %",
                c.verdict,
            ]
            for c in told
        ]
        same = len(self.changes) - len(told)
        title = f"{len(self.slower)} slower, {len(told) - len(self.slower)} faster, {same} alike"
        tables = [(title, header, rows)]
        for names, said in ((self.missing, "only in the old run"), (self.added, "only in the new")):
            if names:
                tables.append((said, ["row"], [[name] for name in names]))
        return tables


def compare(old: Path, new: Path) -> Comparison:
    """Compare what two calls of `make bench` have written.

    InputError: one is no such file, or has another format or yardstick.
    """
    before, after = _read(old), _read(new)
    if before["yardstick"] != after["yardstick"]:
        raise InputError("has another yardstick", where=new, remedy="measure the old one again")
    ours, theirs = _rows(before), _rows(after)
    pairs = [(key, ours[key], theirs[key]) for key in ours if key in theirs]
    return Comparison(
        tuple(change for pair in pairs for change in _change(*pair)),
        tuple(" · ".join(key) for key in ours if key not in theirs),
        tuple(" · ".join(key) for key in theirs if key not in ours),
    )


def _read(path: Path) -> dict[str, Any]:
    content = read_json(path)
    found = content.get("format") if isinstance(content, dict) else None
    if found != FORMAT or "benchmarks" not in content:
        raise InputError(
            f"has format {found}", where=path, expected=f"format {FORMAT}", remedy="run make bench"
        )
    return dict(content)


def _rows(run: dict[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """Return each row by benchmark and name, with the yardstick that was timed beside it."""
    return {
        (benchmark, row["name"]): row | {"yardstick_s": told["yardstick_s"]}
        for benchmark, told in run["benchmarks"].items()
        for row in told["rows"]
    }


def _change(key: tuple[str, str], old: dict[str, Any], new: dict[str, Any]) -> Iterator[Change]:
    """Yield the change of a row that is a speed in both runs."""
    kind = new["kind"]
    values = [_in_yardsticks(row, kind) for row in (old, new)]
    if kind == "figure" or old["kind"] != kind or old["unit"] != new["unit"]:
        return
    if not all(value is not None and value > 0.0 for value in values):
        return
    before, after = (float(value) for value in values if value is not None)
    noise = FLOOR + sum(_noise(row["spread"]) for row in (old, new))
    if kind in {"time", "rate"}:
        noise += sum(_noise(row["yardstick_s"]) for row in (old, new))
    less_is_better = kind in {"time", "cost"}
    by = after / before if less_is_better else before / after
    yield Change(*key, kind, before, after, by, noise)


def _in_yardsticks(row: dict[str, Any], kind: str) -> float | None:
    """Return a time over the yardstick's, a rate times it, a ratio as it is."""
    least: float = row["yardstick_s"][0]
    value: float | None = row["value"]
    if value is None or kind not in {"time", "rate"}:
        return value
    return value / least if kind == "time" else value * least


def _noise(spread: list[float] | None) -> float:
    """Return twice by how much the median repeat is above the fastest, relative."""
    if spread is None or not spread[0] > 0.0:
        return ONCE
    return 2.0 * (spread[1] / spread[0] - 1.0)
