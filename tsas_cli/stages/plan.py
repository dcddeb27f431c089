"""The plan stage: what a dataset's or a rig file's runs could show, as JSON and as tables."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.diagnosis.amplitudes import Amplitude
from tsas_cli.diagnosis.plan import ExperimentPlan, FurtherRun, plan_dataset, plan_rig
from tsas_cli.diagnosis.rig_file import read_rig_file
from tsas_cli.diagnosis.visibility import TINY
from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.quality.copies.deduplicated import without_duplicates
from tsas_cli.recordings.storage import location_text
from tsas_cli.records.plan import EffectSize, ProposedRun, RunPlan, RunProposal, SmallerSize
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, path_of, place_of
from tsas_cli.support.files import folder_if, sha256_of
from tsas_cli.support.steps import NO_PROGRESS, Steps

SAID = 4  # improvements of a proposal that are printed


@dataclass(frozen=True, repr=False, eq=False)
class PlanResult(Result):
    """What a set of runs could show, and which further run helps most."""

    record: RunPlan  # what `plan.json` holds
    plan: ExperimentPlan

    def tables(self) -> Iterator[Table]:
        """Yield each effect, the pairs, the proposals."""
        rows = [
            (
                row.effect,
                row.parameter,
                row.unit,
                _size(row.found_from, "not shown"),
                _size(row.named_from, "" if row.found_from is None else "never"),
                ", ".join(row.hidden_in) or row.nearest or "",
            )
            for row in self.record.effects
        ]
        header = ("effect", "parameter", "unit", "found from", "named from", "nearest")
        yield "smallest size of each effect, less its neutral value", header, rows
        if self.record.groups:
            yield "indistinguishable", ("effect", "and"), self.record.groups
        yield from map(_proposal_table, self.record.proposals)

    def sentences(self) -> list[str]:
        """Return what the runs do not show, and why."""
        return notes(self.record.cannot_tell)


def plan(
    runs: Dataset | Named,
    *,
    out: Named | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> PlanResult:
    """Say from which size on runs would show each effect, and which further run helps most.

    Parameters
    ----------
    runs
        A dataset, its folder, or a rig file with planned runs (docs/plan.md).
    out
        Where to write `plan.json`; None writes nothing.
    force
        Replace the folder if it is there.
    step
        Called for each run that might be added.

    Returns
    -------
    PlanResult
        `.plan` holds what is seen from which size on, and the proposals.

    Raises
    ------
    InputError
        The dataset or the file is wrong, no run shows anything, or `out` exists and `force` is
        not set.
    """
    if not isinstance(runs, Dataset):
        place = place_of(runs)
        runs = place if isinstance(place, Path) and not place.is_dir() else read_dataset(place)
    path = path_of(out)
    read = runs.folder if isinstance(runs, Dataset) else runs
    with folder_if(path, stage="plan", inputs=[read], force=force) as folder:
        if isinstance(runs, Dataset):
            counted = without_duplicates(runs)
            of, planned = counted.dataset.header(path), plan_dataset(counted, step)
        else:
            file = read_rig_file(runs)
            where = location_text(path or Path(), runs)
            rig = {"name": file.name, "file": where, "sha256": sha256_of(runs)}
            of, planned = {"rig": rig}, plan_rig(file, step)
        record = record_of(planned, **of)
        if folder is not None:
            record.write(folder)
    return PlanResult(record.content(), path, record, planned)


def record_of(plan: ExperimentPlan, **of: object) -> RunPlan:
    """Return what `plan.json` says of a plan, and what it is `of`: a dataset or a rig file."""
    return RunPlan(
        **of,
        effects=[
            EffectSize(
                effect=seen.cause.effect.name,
                parameter=seen.cause.parameter.name,
                unit=seen.cause.parameter.unit,
                shape={name.split(".")[1]: value for name, value in seen.cause.shape.items()},
                found_from=_or_any(seen.cause, seen.found),
                named_from=_or_any(seen.cause, seen.named),
                nearest=seen.nearest,
                hidden_in=seen.hidden_in,
            )
            for seen in plan.seen
        ],
        groups=plan.groups,
        proposals=[_proposal(proposal) for proposal in plan.proposals],
        cannot_tell=plan.cannot_tell,
    )


def _or_any(cause: Amplitude, size: float) -> float:
    """Return a size, 0 where any is enough: a second tendon pulls without a preload too."""
    return 0.0 if size < 2.0 * TINY * abs(cause.start) else size


def _proposal(proposal: FurtherRun) -> RunProposal:
    return RunProposal(
        run=ProposedRun.model_validate(proposal.candidate.run, from_attributes=True),
        sentence=proposal.candidate.sentence,
        falls_percent=100.0 * (1.0 - math.exp(-proposal.score)),
        better=[
            SmallerSize(
                effect=better.cause.effect.name,
                parameter=better.cause.parameter.name,
                unit=better.cause.parameter.unit,
                named_from=_or_any(better.cause, better.before),
                named_from_with_it=_or_any(better.cause, better.after),
            )
            for better in proposal.better
        ],
    )


def _proposal_table(proposal: RunProposal) -> Table:
    rows = [
        (
            row.effect,
            row.parameter,
            row.unit,
            _size(row.named_from, "never"),
            _size(row.named_from_with_it, "never"),
        )
        for row in proposal.better[:SAID]
    ]
    title = f"add {proposal.sentence}: sizes fall by {proposal.falls_percent:.0f} % on average"
    return title, ("effect", "parameter", "unit", "named from", "with it"), rows


def _size(value: float | None, otherwise: str) -> str:
    if value is None:
        return otherwise
    return f"{value:.2g}" if value > 0.0 else "any"
