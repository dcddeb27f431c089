"""The table of what became of the mutants, and those that live."""

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from scipy.stats import binomtest

from tsas_cli.support.text_table import table_text

HEADER = ("module", "mutants", "killed", "timed out", "survived", "equivalent", "score [%]", "95 %")
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
Verdict = dict[str, Any]


def equivalents() -> dict[tuple[str, str, str], str]:
    """Return the mutants that nobody can tell from the program, by file and line, and why."""
    entries = tomllib.loads(EQUIVALENT.read_text())["mutant"]
    return {(entry["path"], entry["before"], entry["after"]): entry["why"] for entry in entries}


def lines(verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Yield the table by module, package and in all, and each survivor."""
    known = equivalents()
    told = [verdict | {"outcome": _outcome(verdict, known)} for verdict in verdicts]
    modules = sorted({verdict["path"] for verdict in told})
    packages = sorted({path.rsplit("/", 1)[0] for path in modules})
    rows = []
    for package in packages:
        within = [path for path in modules if path.startswith(package + "/")]
        rows += [_row(path, [v for v in told if v["path"] == path]) for path in within]
    for package in packages:
        rows.append(_row(package, [v for v in told if v["path"].startswith(package + "/")]))
    yield from table_text("Mutants", HEADER, [*rows, _row("all", told)])
    for verdict in told:
        if verdict["outcome"] == "survived":
            yield f"\n{verdict['mutant']} ({verdict['why']})"
            yield f"- {verdict['before']}"
            yield f"+ {verdict['after']}"


def _outcome(verdict: Verdict, known: dict[tuple[str, str, str], str]) -> str:
    """Return what became of a mutant; one that cannot be told counts nowhere if it lives."""
    key = (verdict["path"], verdict["before"], verdict["after"])
    return "equivalent" if verdict["outcome"] == "survived" and key in known else verdict["outcome"]


def _row(name: str, verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """Return one line of the table; who is ended by the clock is noticed."""
    outcomes = [verdict["outcome"] for verdict in verdicts]
    counts = [outcomes.count(o) for o in ("killed", "timed out", "survived", "equivalent")]
    noticed, judged = counts[0] + counts[1], sum(counts[:3])
    score = within = "-"
    if judged:  # Wilson's interval: it holds for few mutants too
        ends = binomtest(noticed, judged).proportion_ci(method="wilson")
        score = f"{100 * noticed / judged:.0f}"
        within = f"{100 * ends.low:.0f} to {100 * ends.high:.0f}"
    return (name.removeprefix("tsas_cli/"), str(len(outcomes)), *map(str, counts), score, within)
