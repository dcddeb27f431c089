"""Errors in the recordings stop a stage before anything is fitted to them."""

from collections.abc import Iterable, Sequence

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality import CODES, check_runs
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.stages.given import listed, one_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import Steps
from tsas_cli.support.wording import count_of

# Warnings that make results wrong where most runs have them; in one run they may be the motion's.
_IN_MOST_RUNS = ("filtered", "repeated-values", "slow-channel", "hum")


def accepted_errors(
    dataset: Dataset, despite: str | Iterable[str], step: Steps, further: Sequence[str] = ()
) -> tuple[Finding, ...]:
    """Return the errors of the checks whose codes are in `despite`; `step` counts runs.

    `further` codes are allowed there too.

    Raises
    ------
    InputError
        There is an error of another code, or `despite` holds what is no code of a check.
    """
    accepted = {one_of((*CODES, *further), code, "despite") for code in listed(despite)}
    found = check_runs(dataset, step).findings
    errors = [
        one
        for one in found
        if one.code in CODES and (one.severity == "error" or _in_most_runs(one, found, dataset))
    ]
    refused = [one for one in errors if one.code not in accepted]
    if refused:
        first, *others = refused
        files = {run.id: run.file for run in dataset.runs}
        options = " ".join(f"--despite {code}" for code in dict.fromkeys(f.code for f in refused))
        more = f" (and {count_of(len(others), 'more error')})" if others else ""
        raise InputError(
            f"{first.sentence}{more}",
            where=MANIFEST_FILE if first.run is None else files[first.run],
            remedy=f"{first.remedy}, or accept what `tsas check` finds with {options}",
        )
    return tuple(errors)


def _in_most_runs(one: Finding, found: Sequence[Finding], dataset: Dataset) -> bool:
    """Return whether a warning is of a kind that most runs have, on the same channel."""
    same = {other.run for other in found if (other.code, other.column) == (one.code, one.column)}
    return one.code in _IN_MOST_RUNS and 2 * len(same) > len(dataset.runs)
