"""One run in memory: its manifest entry, and its columns."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Recording:
    """One run: its manifest entry, and its columns.

    Parameters
    ----------
    run
        What the manifest says of it: conditions, file, checksum.
    columns
        By name (with the unit in it) float64 arrays of shape (n,); NaN where the file has null.
    """

    run: Run
    columns: Mapping[str, Floats]

    def __repr__(self) -> str:
        """Return a line: how many samples of which columns over which time."""
        time_s = self.time_s
        names = " ".join(self.columns)
        return f"run {self.run.id}: {time_s.size} rows, {time_s[-1] - time_s[0]:.6g} s: {names}"

    def frame(self) -> "pd.DataFrame":
        """Return the columns as a pandas table with `time_s` as its index."""
        import pandas as pd

        return pd.DataFrame(dict(self.columns)).set_index(TIME)

    @property
    def time_s(self) -> Floats:
        """Time in s, strictly increasing."""
        return self.columns[TIME]

    def get(self, name: str) -> Floats | None:
        """Return a column, or None where it was not recorded."""
        return self.columns.get(name)


def recording_of(runs: Mapping[str, Recording], run: str) -> Recording:
    """Return a run by its id.

    Raises
    ------
    InputError
        There is none.
    """
    if run not in runs:
        raise InputError(f"there is no run {run!r}", remedy=nearest(run, runs))
    return runs[run]
