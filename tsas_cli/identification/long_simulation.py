"""Simulate a run that is too long for memory, and write the answer row group by row group."""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from tsas_cli.identification.comparison import Told, channels_of, refuse_static
from tsas_cli.identification.long_runs import LongRun, Rows
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import CHANNELS, LOAD_COLUMNS, Prepared, drive_of
from tsas_cli.physics.by_pieces import simulate_pieces
from tsas_cli.physics.ends import Drive
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import Dynamics, Response
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.writing import parquet_writer, table_of
from tsas_cli.support.errors import InputError

Floats = npt.NDArray[np.float64]


@dataclass
class _Sums:
    """What is counted of the answers, row by row."""

    rows: int = 0
    slack: int = 0
    unsettled: int = 0
    squares: dict[str, float] = field(default_factory=dict)
    samples: dict[str, int] = field(default_factory=dict)

    def add(self, response: Response, channels: dict[str, Floats], rows: Rows) -> None:
        """Count some rows."""
        self.rows += rows.time_s.size
        self.slack += int(np.count_nonzero(response.phase == SLACK))
        self.unsettled += int(np.count_nonzero(response.phase == UNCONVERGED))
        for name, measured in rows.measured.items():
            error = measured - channels[name]
            error = error[np.isfinite(error)]
            self.squares[name] = self.squares.get(name, 0.0) + float(np.sum(error**2))
            self.samples[name] = self.samples.get(name, 0) + error.size

    def told(self, solver: str) -> Told:
        """Return what is told of the whole answer."""
        rmse = {
            name: math.sqrt(square / self.samples[name]) if self.samples[name] else math.nan
            for name, square in self.squares.items()
        }
        return Told(solver, self.rows, self.slack, self.unsettled, rmse, self.samples)


def simulate_long(
    long: LongRun, model: Model, dynamics: Dynamics, nodes: int | None, folder: Path | None
) -> tuple[Told, Prepared]:
    """Simulate a run, a piece at a time, and write the answer into a folder.

    Returns what is told of the answer, and the run as a fit would see it.

    Raises
    ------
    InputError
        There is no folder, or the model is asked for what it cannot do.
    """
    refuse_static(long.run, long.drive_column, dynamics)
    if folder is None or dynamics == "lugre":
        cannot = "answered in memory" if folder is None else "followed with the dynamic model"
        raise InputError(
            f"{long.columns.rows} samples are too many to be {cannot}",
            where=f"run {long.run.id}",
            remedy="give a folder with --out" if folder is None else "use --dynamics slip",
        )
    waiting: deque[Rows] = deque()
    kept: list[Rows] = []
    sums, solver = _Sums(), ""
    driven = long.plans.keys()
    names = [TIME, "x_in_mm", *(name for name in CHANNELS if name not in driven)]
    answers = simulate_pieces(
        model.rig(long.run),
        _drives(long, waiting),
        dynamics,
        on_mesh=nodes is not None,
        nodes=nodes,
    )
    schema = pa.schema([(name, pa.float64()) for name in names])
    with parquet_writer(folder / f"{long.run.id}.parquet", schema) as write:
        for response in answers:
            rows, solver = waiting.popleft(), response.solver
            channels = channels_of(response, driven, rows.in_gap)
            columns = {TIME: rows.time_s, "x_in_mm": response.x_in_mm, **channels}
            write(table_of({name: columns[name] for name in names}))
            sums.add(response, channels, rows)
            kept.append(long.thin(rows))
    return sums.told(solver), long.thinned(kept)


def _drives(long: LongRun, waiting: deque[Rows]) -> Iterator[Drive]:
    """Yield what drives each piece of a run; its rows wait for the answer."""
    load = LOAD_COLUMNS.get(long.run.load)
    begin_s = 0.0
    for rows in long.rows():
        if rows.start == 0:
            begin_s = float(rows.time_s[0])
        waiting.append(rows)
        drive = drive_of(
            long.run,
            rows.time_s,
            rows.cleaned[long.drive_column].values,
            by_force=long.drive_column == "f_in_N",
            load_values=None if load is None else rows.cleaned[load].values,
            f_in_N=rows.measured.get("f_in_N") if rows.start == 0 else None,
            session_s=long.session_s,
        )
        yield replace(drive, time_s=rows.time_s - begin_s)
