"""A dataset in which each sample counts once, for fits and for the evidence of a diagnosis.

A run that is a copy as a whole is left out. A stretch that two runs share has zero weight in one of
them, as a gap has.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality.copies.search import WHOLE_SHARE, Copy, find_copies
from tsas_cli.recordings.recording import NONE_COPIED, CopiedRows
from tsas_cli.support.errors import InputError


@dataclass(frozen=True)
class DeduplicatedDataset:
    """The runs without whole copies, their duplicate rows, and notes for the user."""

    dataset: Dataset
    copied: Mapping[str, CopiedRows] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def copied_of(self, run: str) -> CopiedRows:
        """Return the duplicate rows of a run."""
        return self.copied.get(run, NONE_COPIED)


def without_duplicates(dataset: Dataset) -> DeduplicatedDataset:
    """Return a dataset without duplicate samples.

    InputError: a run cannot be read, or two runs hold the same samples under different conditions.
    """
    by_run: dict[str, list[Copy]] = {}
    for copy in find_copies(dataset).copies:
        if copy.contradicts:
            raise InputError(
                f"run {copy.run.id} {copy.sentence}{copy.contradiction}",
                where=dataset.folder / MANIFEST_FILE,
                remedy="correct the conditions, or leave one of the two out with --runs",
            )
        by_run.setdefault(copy.run.id, []).append(copy)
    copied = {
        run: CopiedRows(tuple((copy.span.first, copy.span.end) for copy in copies))
        for run, copies in by_run.items()
    }
    rows = {run: copies[0].all_of_run.rows for run, copies in by_run.items()}
    removed = {run for run in copied if copied[run].mask(0, rows[run]).mean() >= WHOLE_SHARE}
    kept = dataset.only(r.id for r in dataset.runs if r.id not in removed) if removed else dataset
    return DeduplicatedDataset(
        kept,
        {run: rows for run, rows in copied.items() if run not in removed},
        tuple(
            f"Run {run} {'; '.join(copy.sentence for copy in copies)}: "
            f"{'it is left out' if run in removed else 'there it has no weight'}, so that no "
            "sample counts twice."
            for run, copies in by_run.items()
        ),
    )
