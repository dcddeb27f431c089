"""Turn files of a rig into a dataset."""

from collections.abc import Iterable
from dataclasses import dataclass

from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.guess.proposal import MapProposal, propose
from tsas_cli.recordings.guess.text import MAP_MARK, content, map_text, tables
from tsas_cli.recordings.ingest import Ingested, find_files, ingest_files
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.records.result import Result, Table, heading, notes
from tsas_cli.stages.given import Named, file_of, path_of, paths_of
from tsas_cli.support.files import new_file, new_folder
from tsas_cli.support.replacing import sealed
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True, repr=False, eq=False)
class GuessResult(Result):
    """A proposed map; its text is `map`, which is what is printed where nothing was written."""

    proposal: MapProposal  # which column each channel takes, how sure that is, what is open

    @property
    def map(self) -> str:
        """The map as commented TOML, to be edited."""
        return map_text(self.proposal)

    def intro(self) -> list[str]:
        """Return the map where it was not written."""
        return [] if self.out is not None else self.map.splitlines()

    def tables(self) -> list[Table]:
        """Return what the map that was written says, and what is open."""
        return [] if self.out is None else list(tables(self.proposal, self.out))


@dataclass(frozen=True, repr=False, eq=False)
class IngestResult(Result):
    """What became of the files."""

    dataset: Dataset
    runs: tuple[Ingested, ...]  # of each file: rows, duration, rate, columns

    def tables(self) -> list[Table]:
        """Return a row for each run."""
        header = ("run", "rows", "duration", "rate", "columns")
        rows = [
            (
                r.run,
                f"{r.rows}",
                f"{r.duration_s:.6g} s",
                f"{r.rate_Hz:.6g} Hz",
                " ".join(r.columns),
            )
            for r in self.runs
        ]
        return [(f"dataset {self.out}", header, rows)]

    def sentences(self) -> list[str]:
        """Return which units of the map are not those of the files, each once."""
        return notes([*dict.fromkeys(note for run in self.runs for note in run.notes)])


def ingest(
    sources: Named | Iterable[Named],
    *,
    map: Named,  # noqa: A002 # as the option is called
    out: Named,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> IngestResult:
    """Turn files of a rig into a dataset, as a map says.

    Parameters
    ----------
    sources
        Files (docs/ingest.md lists the formats), or folders to search; one or several.
    map
        The file that says which column is what, in which unit (docs/ingest.md).
    out
        The dataset's folder to write; what makes recordings has no use without it.
    force
        Replace the folder if it is there.
    step
        Called twice for each file: opened, written.

    Returns
    -------
    IngestResult
        What became of each file; `.dataset` is the dataset.

    Raises
    ------
    InputError
        The map or a file is wrong, or `out` exists and `force` is not set; nothing is written then.
    """
    map_path, folder = file_of(map), file_of(out)
    mapping = read_map(map_path)
    files = find_files(paths_of(sources), mapping.read.files)
    with new_folder(folder, stage="ingest", inputs=[*files, map_path], force=force) as written:
        runs = ingest_files(files, mapping, map_path, written, step=step)
    summary = heading("ingest") | {
        "dataset": {"name": mapping.dataset.name, "folder": str(folder)},
        "runs": [vars(run) | {"source": str(run.source)} for run in runs],
    }
    return IngestResult(summary, folder, read_dataset(folder), tuple(runs))


def guess(
    sources: Named | Iterable[Named], *, out: Named | None = None, force: bool = False
) -> GuessResult:
    """Propose a map for files from names, units and the look of the signals.

    Parameters
    ----------
    sources
        Files, or folders to search; one or several.
    out
        The map to write; None writes nothing.
    force
        Replace the file if it is there.

    Returns
    -------
    GuessResult
        `.map` is commented TOML to edit; nothing in it is sure before a person has read it.

    Raises
    ------
    InputError
        None of the files can be read, or `out` exists and `force` is not set.
    """
    files, path = find_files(paths_of(sources), "*"), path_of(out)
    proposal = propose(files)
    summary = heading("guess") | content(proposal)
    if path is not None:
        with new_file(path, mark=MAP_MARK, inputs=files, force=force) as written:
            written.write_text(sealed(map_text(proposal)), encoding="utf-8")
    return GuessResult(summary, path, proposal)
