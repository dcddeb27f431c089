"""What stages have written about runs, `runs/ID.parquet` in a folder of theirs, read again."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from tsas_cli.recordings.arrow_columns import floats_from
from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.parquet_files import check_size, open_parquet
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import read_columns
from tsas_cli.recordings.run_names import check_run_name
from tsas_cli.support.errors import InputError
from tsas_cli.support.memory import out_of_memory

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class WrittenRuns(Mapping[str, Recording]):
    """Runs that a stage has written into a folder, each read when it is asked for."""

    folder: Path
    runs: Mapping[str, Run]

    def __getitem__(self, run: str) -> Recording:
        """Read a run.

        Raises
        ------
        KeyError
            There is none.
        InputError
            Its file is no longer what the stage has written.
        """
        return Recording(self.runs[run], read_columns(self.folder / f"{run}.parquet"))

    def __contains__(self, run: object) -> bool:
        """Say whether there is such a run, without reading it."""
        return run in self.runs

    def __iter__(self) -> Iterator[str]:
        """Return the ids, in the order of the dataset."""
        return iter(self.runs)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.runs)


def answers_of(folder: Path, run: str) -> Path:
    """Return the file that a stage has written about a run into a folder.

    Raises
    ------
    InputError
        The run's id leads out of the folder, or a link does.
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
    """Return the columns of such a file.

    Raises
    ------
    InputError
        It cannot be read.
    """
    try:
        with open_parquet(path) as file:
            return list(file.schema_arrow.names)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise damaged(path, "Parquet", error) from error


def columns_of(path: Path, names: Sequence[str]) -> dict[str, Floats]:
    """Read columns of such a file by name, shape (n,) each, null as NaN.

    Raises
    ------
    InputError
        It cannot be read or lacks a column.
    """
    try:
        with open_parquet(path) as file:
            check_size(file, path, names, whole=True)
            table = file.read(columns=list(names))
        return {name: floats_from(table.column(name)) for name in names}
    except MemoryError as error:
        raise out_of_memory(path) from error
    except (pa.ArrowException, OSError, KeyError, UnicodeDecodeError) as error:
        raise damaged(path, "Parquet", error) from error


def check_rows(path: Path, found: int, rows: int, *, stage: str = "the stage") -> None:
    """Refuse a file that was written about another recording, of other than so many samples.

    Raises
    ------
    InputError
        It has another number of rows; running `stage` again mends that.
    """
    if found != rows:
        raise InputError(
            f"{found} rows",
            where=path,
            expected=f"{rows}, as the recording has",
            remedy=f"run {stage} again",
        )
