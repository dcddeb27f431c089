"""The close-loop stage: hidden effects recorded, diagnosed and tracked, into one table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.records.closing import HIDDEN, ClosingFile
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, at_least, listed, path_of
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import stage_folder
from tsas_cli.support.limits import SEEDS
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.tracking.conditions import disturbed
from tsas_cli.tracking.settings import read_settings
from tsas_studies.closing.cases import CASES, MODELS, STEPS, HiddenCase, close


@dataclass(frozen=True, repr=False, eq=False)
class ClosingResult(Result):
    """What a better model is worth in tracking, case by case."""

    record: ClosingFile  # what `closing.json` holds

    def tables(self) -> list[Table]:
        """Return what was hidden and named, and the RMSE by model."""
        return _tables(self.record, self.titled("what was hidden, and named"))


def chosen(names: Sequence[str] | None, hide: Sequence[str]) -> tuple[HiddenCase, ...]:
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
        return (HiddenCase(HIDDEN, ", ".join(hide), {c.quantity: c.value for c in changes}),)
    known = {case.name: case for case in CASES}
    wanted = list(known) if names is None else list(names)
    for name in wanted:
        if name not in known:
            raise InputError(f"unknown case {name}", where="--cases", remedy=nearest(name, known))
    return tuple(known[name] for name in wanted)


def close_loop(
    *,
    out: Named,
    cases: str | Sequence[str] | None = None,
    hide: str | Sequence[str] = (),
    settings: Named | None = None,
    seeds: int = 5,
    first_seed: int = 1,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> ClosingResult:
    """Record, diagnose and track with the nominal, the extended and the true model side by side.

    Parameters
    ----------
    out
        Where to write `closing.json` and, for each case, its recordings and what the stages say
        of them; each stage reads what the one before has written.
    cases
        The names of the known cases that are taken; all without it.
    hide
        Changes `NAME=VALUE` of the plant to hide in place of the known cases.
    settings
        A file with rig, drive, sensors, reference and gains (docs/tracking.md).
    seeds
        How many seeds of noise.
    first_seed
        The first of them.
    force
        Replace the folder if it is there.
    step
        Called seven times for each case.

    Returns
    -------
    ClosingResult
        `.record.cases` holds by case what was hidden, what was named, and the scores by
        controller and model (RMSE in N).

    Raises
    ------
    InputError
        A case or a setting is wrong, a loop is unstable, or `out` exists and `force` is not set.
    """
    wanted = chosen(None if cases is None else listed(cases), listed(hide))
    given, path = path_of(settings, Mapping), Path(out)
    read, first = read_settings(given), at_least(0, first_seed, "first_seed")
    taken = range(first, first + at_least(1, seeds, "seeds", most=SEEDS))
    with stage_folder(path, stage="close-loop", inputs=[given], force=force) as folder:
        step.ahead(STEPS * len(wanted))
        found = [close(case, read, folder / case.name, taken, step) for case in wanted]
        record = ClosingFile(
            settings=read.model_dump(mode="json", by_alias=True),
            seeds=(taken[0], taken[-1]),
            cases=found,
        )
        record.write(folder)
    return ClosingResult(record.content(), path, record)


def _tables(record: ClosingFile, title: str) -> list[Table]:
    """Return what was hidden and named, under its title, and the RMSE by model."""
    named = [
        (
            case.title,
            case.verdict,
            ", ".join(" or ".join([c.effect, *c.rivals]) for c in case.named) or "nothing",
        )
        for case in record.cases
    ]
    rows = [
        (
            case.case,
            row.controller,
            *(f"{rmse.mean:.4f}" for rmse in row.by_model.values()),
            f"{row.over_limit:.2f}",
        )
        for case in record.cases
        for row in case.controllers
    ]
    header = ("hidden", "controller", *MODELS, "extended/true")
    return [
        (title, ("hidden", "verdict", "named"), named),
        ("RMSE of the force in N, by the model of inverse and feedforward", header, rows),
    ]
