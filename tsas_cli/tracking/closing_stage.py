"""The close-loop stage: hidden effects recorded, diagnosed and tracked, into one table."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli import __version__
from tsas_cli.errors import InputError, nearest
from tsas_cli.files import stage_folder, write_json
from tsas_cli.result import Result, Table
from tsas_cli.steps import SILENT, Steps
from tsas_cli.tracking.closing import CASES, MODELS, STEPS, Case, close
from tsas_cli.tracking.conditions import disturbed
from tsas_cli.tracking.settings import Settings


@dataclass(frozen=True, repr=False, eq=False)
class ClosingResult(Result):
    """What a better model is worth in tracking, case by case."""

    def tables(self) -> list[Table]:
        """Return what was hidden and named, and the RMSE by model."""
        return _tables(self.summary, self.titled("what was hidden, and named"))


def chosen(names: Sequence[str] | None, hide: Sequence[str]) -> tuple[Case, ...]:
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
    wanted = list(known) if names is None else list(names)
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
    inputs: Iterable[object] = (),
    force: bool = False,
    step: Steps = SILENT,
) -> ClosingResult:
    """Close the loop on each case; write `closing.json` and what the stages wrote on the way.

    `inputs` are the files that the settings come from.

    Raises
    ------
    InputError
        A loop is unstable, or `out` exists and `force` is not set.
    """
    with stage_folder(out, stage="close-loop", inputs=inputs, force=force) as folder:
        step.ahead(STEPS * len(cases))
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
    return ClosingResult(summary, out)


def _tables(summary: dict[str, Any], title: str) -> list[Table]:
    """Return what was hidden and named, under its title, and the RMSE by model."""
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
        (title, ("hidden", "verdict", "named"), named),
        ("RMSE of the force in N, by the model of inverse and feedforward", header, rows),
    ]
