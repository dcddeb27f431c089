"""What `tsas challenge score` prints: the entries side by side, then each by effect."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from tsas_studies.challenge.truth import CATALOGUE

Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]
_CLASSES = ("exact", "rivals", "false", "none", "cases")
_MET = {True: "yes", False: "no", None: ""}


def tables(content: dict[str, Any]) -> Iterator[Table]:
    """Yield the tables of a score; `content` is what `score.json` holds."""
    yield _summary(content)
    missing = content["answers"]["effects_not_in_the_set"]
    if missing:
        yield f"not in this set by themselves: {', '.join(missing)}", (), ()
    for label, entry in content["entries"].items():
        yield _effects(label, entry["effects"])
        confusion = [(c["hidden"], c["said"], str(c["cases"])) for c in entry["confusion"]]
        yield f"{label}: what was said for what", ("hidden", "said", "cases"), confusion
        if entry["no_answer"]:
            reasons = list(entry["no_answer"].items())
            yield f"{label}: no answer", ("case", "reason"), reasons


def _summary(content: dict[str, Any]) -> Table:
    entries = list(content["entries"].values())
    columns = _beside(content["entries"], ["met"] * len(entries))
    blank = [""] * len(entries)
    rows: list[tuple[str, ...]] = []
    for figures in zip(*(entry["figures"] for entry in entries), strict=True):
        title, target = figures[0]["title"], figures[0]["target"] or ""
        met = [_MET[f["met"]] for f in figures]
        if any(f["worst"] for f in figures):
            rows.append((title, "", *_beside(map(_rate, figures), blank)))
            worst = (
                f"{w['hits']} of {w['cases']}, {w['effect']}" if w else "no cases"
                for w in (f["worst"] for f in figures)
            )
            rows.append(("  the worst effect", target, *_beside(worst, met)))
        else:
            rows.append((title, target, *_beside(map(_rate, figures), met)))
    rows += [
        ("rivals beside each name, mean", "", *_beside(map(_rivals, entries), blank)),
        ("held-out gain of the attainable, median", "", *_beside(map(_gain, entries), blank)),
        ("seconds per case", "", *_beside(map(_seconds, entries), blank)),
    ]
    cases = ", ".join(f"{n} {kind}" for kind, n in content["answers"]["cases"].items())
    seed = content["answers"]["seed"]
    of = f"seed {seed}" if isinstance(seed, int) else f"seeds {', '.join(map(str, seed))}"
    title = f"set of {of}: {cases}; rates with 95 % intervals"
    return title, ("figure", "target", *columns), rows


def _beside(cells: Iterable[str], met: Iterable[str]) -> list[str]:
    return [part for pair in zip(cells, met, strict=True) for part in pair]


def _rate(figure: dict[str, Any]) -> str:
    if not figure["cases"]:
        return "no cases"
    low, high = 100 * figure["interval_low"], 100 * figure["interval_high"]
    return f"{100 * figure['share']:.1f} % [{low:.1f}, {high:.1f}] of {figure['cases']}"


def _rivals(entry: dict[str, Any]) -> str:
    found = entry["rivals_per_name"]
    return f"{found['mean']:.2f}" if found["names"] else "nothing named"


def _gain(entry: dict[str, Any]) -> str:
    found = entry["gain"]
    return f"{100 * found['median']:.1f} % of {found['cases']}" if found["cases"] else "no cases"


def _seconds(entry: dict[str, Any]) -> str:
    found = entry["seconds"]
    if not found["cases"]:
        return "not said"
    return f"median {found['median']:.3g}, max {found['max']:.3g}"


def _effects(label: str, rows: Sequence[dict[str, Any]]) -> Table:
    """Return a row for each effect, in the catalogue's order; the sizes stand side by side."""
    found = {(row["effect"], row["size"]): row for row in rows}
    sizes = sorted({size for _, size in found}, reverse=True)
    lines = []
    for effect in CATALOGUE:
        cells = [found.get((effect, size), {}) for size in sizes]
        if any(cells):
            lines.append((effect, *(str(c.get(name, "")) for c in cells for name in _CLASSES)))
    header = [name for size in sizes for name in (f"{size:g}: {_CLASSES[0]}", *_CLASSES[1:])]
    return f"{label}: single effects, number of cases by size", ("effect", *header), lines
