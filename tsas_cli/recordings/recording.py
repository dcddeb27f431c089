"""One run in memory: its manifest entry, its columns, and which of its rows are copies."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False, eq=False)
class Recording:
    """One run: its manifest entry, and its columns.

    Parameters
    ----------
    run
        Its manifest entry: conditions, file, checksum.
    columns
        float64 arrays of shape (n,) by name (with the unit); null is NaN. Those of a dataset are
        read-only: each access reads its file, so that a change would be lost.
    """

    run: Run
    columns: Mapping[str, Floats]

    def __repr__(self) -> str:
        """Return one line with the number of samples, the duration and the columns."""
        time_s = self.time_s
        names = " ".join(self.columns)
        return f"run {self.run.id}: {time_s.size} rows, {time_s[-1] - time_s[0]:.6g} s: {names}"

    def __reduce__(self) -> tuple[object, ...]:
        """Let it be copied and pickled, with columns that may be written to."""
        return type(self), (self.run, {n: np.array(v) for n, v in self.columns.items()})

    def read_only(self) -> "Recording":
        """Return it with columns that cannot be written to."""
        for values in self.columns.values():
            values.flags.writeable = False
        return replace(self, columns=MappingProxyType(self.columns))

    def frame(self) -> "pd.DataFrame":
        """Return the columns as a pandas table with `time_s` as its index."""
        import pandas as pd

        return pd.DataFrame(dict(self.columns)).set_index(TIME)

    @property
    def time_s(self) -> Floats:
        """Time in s, strictly increasing."""
        return self.columns[TIME]

    def get(self, name: str) -> Floats | None:
        """Return a column, or None if it was not recorded."""
        return self.columns.get(name)


def recording_of(runs: Mapping[str, Recording], run: str) -> Recording:
    """Return a run by its id; InputError: there is no such run."""
    if run not in runs:
        raise InputError(f"there is no run {run!r}", remedy=nearest(run, runs))
    return runs[run]


@dataclass(frozen=True)
class CopiedRows:
    """Stretches of rows, each from its first row to the one after its last."""

    stretches: tuple[tuple[int, int], ...] = ()

    def mask(self, start: int, stop: int) -> Mask:
        """Return which of the rows from `start` to `stop` − 1 are copies, shape (stop − start,)."""
        copied = np.zeros(stop - start, dtype=np.bool_)
        for first, end in self.stretches:
            copied[max(first - start, 0) : max(end - start, 0)] = True
        return copied


NONE_COPIED = CopiedRows()
