"""The close-loop stage: hidden effects recorded, diagnosed and tracked, into one table."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tsas_cli import __version__
from tsas_cli.errors import InputError, nearest
from tsas_cli.files import new_folder, write_json
from tsas_cli.tracking.closing import CASES, MODELS, Case, close
from tsas_cli.tracking.conditions import disturbed
from tsas_cli.tracking.settings import Settings

Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


def chosen(names: str | None, hide: Sequence[str]) -> tuple[Case, ...]:
    """Return the cases by name, or one that hides what options such as `NAME=VALUE` say.

    Raises
    ------
    InputError
        There is no such case, or a change is none; it begins during the run.
    """
    if hide:
        changes = disturbed(hide, "--hide").changes
        if any(change.from_s > 0.0 for change in changes):
            raise InputError("a hidden effect begins with the run", where="--hide")
        return (Case("hidden", ", ".join(hide), {c.name: c.value for c in changes}),)
    known = {case.name: case for case in CASES}
    wanted = list(known) if names is None else [name.strip() for name in names.split(",")]
    for name in wanted:
        if name not in known:
            raise InputError(f"unknown case {name}", where="--cases", remedy=nearest(name, known))
    return tuple(known[name] for name in wanted)


def close_all(
    cases: Sequence[Case],
    settings: Settings,
    out: Path,
    seeds: Sequence[int],
    *,
    force: bool = False,
    step: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Close the loop on each case; write `closing.json` and what the stages wrote on the way.

    Raises
    ------
    InputError
        A loop is unstable, or `out` exists and `force` is not set.
    """
    with new_folder(out, force=force) as folder:
        found = [close(case, settings, folder / case.name, seeds, step) for case in cases]
        summary = {
            "format": 1,
            "stage": "close-loop",
            "version": __version__,
            "settings": settings.model_dump(mode="json", by_alias=True),
            "seeds": [seeds[0], seeds[-1]],
            "cases": found,
        }
        write_json(folder / "closing.json", summary)
    return summary


def tables(summary: dict[str, Any], out: Path) -> list[Table]:
    """Return what is printed: what was hidden and named, and the RMSE by model."""
    named = [
        (
            case["title"],
            case["verdict"],
            ", ".join(" or ".join([c["effect"], *c["rivals"]]) for c in case["named"]) or "nothing",
        )
        for case in summary["cases"]
    ]
    rows = [
        (
            case["case"],
            row["controller"],
            *(f"{row['models'][model]['rmse_N']['mean']:.4f}" for model in MODELS),
            f"{row['over_limit']:.2f}",
        )
        for case in summary["cases"]
        for row in case["controllers"]
    ]
    header = ("hidden", "controller", *MODELS, "extended/true")
    return [
        (f"what was hidden, and named → {out}", ("hidden", "verdict", "named"), named),
        ("RMSE of the force in N, by the model of inverse and feedforward", header, rows),
    ]
