"""Hold two models, or what two stages wrote, against each other."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.comparing import stage, tracked
from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.compare import compare as compare_sides
from tsas_cli.comparing.tracked import Tracks, are_tracked, compare_tracked
from tsas_cli.identification.model import Model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.records.comparison import ModelComparison, TrackedComparison
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, file_of, path_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True, repr=False, eq=False)
class CompareResult(Result):
    """What differs between A and B, and whether that is more than the uncertainty."""

    record: ModelComparison | TrackedComparison  # what `compare.json` holds

    def tables(self) -> list[Table]:
        """Return the values, effects and errors of both sides."""
        if isinstance(self.record, TrackedComparison):
            return tracked.tables(self.record)
        return stage.tables(self.record)

    def sentences(self) -> list[str]:
        """Return what was found, and what limits it."""
        return [*self.record.findings, *notes(self.record.notes)]


def compare(
    a: Model | Named,
    b: Model | Named,
    *,
    out: Named | None = None,
    on: Dataset | Named | None = None,
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> CompareResult:
    """Say what differs between two models, and whether that is more than the uncertainty.

    Parameters
    ----------
    a
        A model, its file, or a folder that `tsas calibrate`, `diagnose`, `simulate` or `track`
        wrote.
    b
        What it is compared with, likewise.
    out
        Where to write `compare.json` and `report.html`; None writes nothing.
    on
        A dataset that both models are simulated on.
    runs
        The ids of its runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Called once for each simulation and section.

    Returns
    -------
    CompareResult
        `.summary["parameters"]` holds the values of both sides, with the interval of their
        difference where there is one, in the parameter's unit.

    Raises
    ------
    InputError
        A or B is none of these, there is nothing that both hold, a recording cannot be read, an
        option has nothing to work on, or `out` exists and `force` is not set.
    """
    sides = [side if isinstance(side, Model) else file_of(side) for side in (a, b)]
    paths = [side for side in sides if isinstance(side, Path)]
    tracks = len(paths) == len(sides) and are_tracked(*paths)
    if tracks and on is not None:
        raise InputError("closed loops have recordings of their own", where="--on")
    if runs is not None and on is None:
        raise InputError("there is no dataset to take runs of", where="--runs", remedy="add --on")
    data, path = None if on is None else dataset_of(on, runs), path_of(out)
    inputs = paths if data is None else [*paths, data.folder]
    with folder_if(path, stage="compare", inputs=inputs, force=force) as folder:
        both = compare_tracked(*paths) if tracks else compare_sides(*sides, on=data, step=step)
        record = both.record if isinstance(both, Tracks) else stage.record_of(both)
        if folder is not None:
            record.write(folder)
            (folder / "report.html").write_text(_page(both, step), encoding="utf-8")
    return CompareResult(record.content(), path, record)


def _page(both: Comparison | Tracks, step: Steps) -> str:
    from tsas_cli.reporting.comparing import comparison_page, tracked_page

    return tracked_page(both, step) if isinstance(both, Tracks) else comparison_page(both, step)
