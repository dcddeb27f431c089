"""What `calibrate` and `diagnose` do with recordings before they fit a model."""

from collections.abc import Container, Iterable, Iterator, Sequence

from tsas_cli.identification.long_runs import open_long
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality import CODES, check_runs
from tsas_cli.recordings.quality.copies.deduplicated import DeduplicatedDataset
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.stages.given import listed, one_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import Steps
from tsas_cli.support.wording import count_of

_SHOWN_BY = {
    "x_in_mm": "the stiffness of the tendon, motion lost at the drive and errors of the proximal "
    "position sensor cannot be judged",
    "x_out_mm": "motion lost at the load and errors of the distal position sensor cannot be judged",
    "f_in_N": "the level of friction rests on the stiffness of the tendon, and errors of the "
    "proximal force sensor cannot be judged",
    "f_out_N": "the tension at the load rests on its stiffness, and errors of the distal force "
    "sensor cannot be judged",
}


def errors_and_warnings(
    dataset: Dataset, despite: str | Iterable[str], step: Steps, further: Sequence[str] = ()
) -> dict[str, tuple[Finding, ...]]:
    """Return what the checks find: the errors whose codes are in `despite`, and the warnings.

    By their names in `OfDataset`. `further` codes are allowed in `despite` too; `step` counts runs.

    InputError: there is an error of another code, or `despite` holds what is no code of a check.
    """
    accepted = {one_of((*CODES, *further), code, "despite") for code in listed(despite)}
    found = [one for one in check_runs(dataset, step).findings if one.code in CODES]
    errors = [one for one in found if one.severity == "error"]
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
    warnings = [one for one in found if one.severity == "warning"]
    return {"despite": tuple(errors), "warnings": tuple(warnings)}


def prepared_runs(
    counted: DeduplicatedDataset, step: Steps, *, thinned: bool = False
) -> list[Prepared]:
    """Return the runs as a fit takes them, after saying what is not recorded; `step` counts runs.

    With `thinned`, some samples are taken of a run that is too long for memory.
    """
    data, prepared = counted.dataset, []
    session_start = data.manifest.session_start
    for run in data.runs:
        copied = counted.copied_of(run.id)
        if thinned and (long := open_long(data, run, session_start, copied)) is not None:
            prepared.append(long.prepared())
        else:
            prepared.append(prepare(data[run.id], session_start, copied))
        step()
    for sentence in unrecorded([{*run.conditioned, *run.measured} for run in prepared]):
        step.say(sentence)
    return prepared


def unrecorded(columns: Sequence[Container[str]]) -> Iterator[str]:
    """Yield a sentence for each missing displacement or tension: what cannot be judged without it.

    `columns` holds the names of those that each run has.
    """
    for name, cannot in _SHOWN_BY.items():
        without = sum(name not in names for names in columns)
        if without:
            where = "" if without == len(columns) else f" in {without} of {len(columns)} runs"
            yield f"{name.rpartition('_')[0]} is not recorded{where}: without it, {cannot}."
