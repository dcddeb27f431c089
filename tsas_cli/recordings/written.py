"""Results of stages for single runs, read from `runs/ID.parquet` in a stage's folder."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.recordings.arrow_columns import floats_from
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.parquet_files import check_size, open_parquet, reading
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import read_columns
from tsas_cli.recordings.run_names import check_run_name
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError


@dataclass(frozen=True)
class WrittenRuns(Mapping[str, Recording]):
    """Runs that a stage has written into a folder, each read on access."""

    folder: Path
    runs: Mapping[str, Run]

    def __getitem__(self, run: str) -> Recording:
        """Return a run.

        Raises
        ------
        KeyError
            There is no such run.
        InputError
            Its file is missing or damaged.
        """
        return Recording(self.runs[run], read_columns(self.folder / f"{run}.parquet"))

    def __contains__(self, run: object) -> bool:
        """Return whether there is such a run, without reading it."""
        return run in self.runs

    def __iter__(self) -> Iterator[str]:
        """Iterate over the ids, in the order of the dataset."""
        return iter(self.runs)

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.runs)


def result_file(folder: Path, run: str) -> Path:
    """Return the file of a stage's result for a run.

    InputError: the run's id leads out of the folder, or a link does.
    """
    path = folder / "runs" / f"{run}.parquet"
    try:
        check_run_name(run)
    except ValueError as error:
        raise InputError(f"run id {run[:80]!r} {error}", where=folder) from error
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError("a link leads out of its folder", where=path)
    return path


def names_of(path: Path) -> list[str]:
    """Return the names of the columns of such a file."""
    with reading(path), open_parquet(path) as file:
        return list(file.schema_arrow.names)


def columns_of(path: Path, names: Sequence[str]) -> dict[str, Floats]:
    """Return columns of such a file by name, shape (n,) each, null as NaN.

    InputError: the file cannot be read or lacks a column.
    """
    with reading(path), open_parquet(path) as file:
        check_size(file, path, names, whole=True)
        table = file.read(columns=list(names))
        missing = [name for name in names if name not in table.column_names]
        if missing:
            raise InputError(f"column {missing[0]} is missing", where=path)
        return {name: floats_from(table.column(name)) for name in names}


def check_rows(path: Path, found: int, rows: int, *, stage: str = "the stage") -> None:
    """Refuse a result whose number of samples differs from the recording's."""
    if found != rows:
        raise InputError(
            f"{found} rows",
            where=path,
            expected=f"{rows}, as the recording has",
            remedy=f"run {stage} again",
        )
