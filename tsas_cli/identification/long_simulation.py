"""Simulate a run that is too long for memory; the prediction is written by row groups."""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow as pa

from tsas_cli.identification.comparison import RunSummary, channels_of, refuse_invalid, summary_of
from tsas_cli.identification.long_runs import LongRun, Rows
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import CHANNELS, LOAD_COLUMNS, Prepared, drive_of
from tsas_cli.physics.by_pieces import simulate_pieces
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.writing import parquet_writer, table_of
from tsas_cli.support.errors import InputError


def simulate_long(
    long: LongRun, model: Model, dynamics: Dynamics, nodes: int | None, folder: Path | None
) -> tuple[RunSummary, Prepared]:
    """Return the summary of a run simulated piece by piece, and the run thinned as for a fit.

    The prediction is written into a folder.

    InputError: there is no folder, or the model is not valid for the run or for pieces.
    """
    refuse_invalid(long.run, model, long.drive_column, dynamics)
    if folder is None or dynamics == "lugre":
        cannot = "returned in memory" if folder is None else "simulated with the dynamic model"
        raise InputError(
            f"{long.columns.rows} samples are too many to be {cannot}",
            where=f"run {long.run.id}",
            remedy="give a folder with --out" if folder is None else "use --dynamics slip",
        )
    waiting: deque[Rows] = deque()
    thinned: list[Rows] = []
    parts: list[RunSummary] = []
    driven = long.plans.keys()
    names = [TIME, "x_in_mm", *(name for name in CHANNELS if name not in driven)]
    pieces = simulate_pieces(model.rig(long.run), _drives(long, waiting), dynamics, nodes=nodes)
    schema = pa.schema([(name, pa.float64()) for name in names])
    with parquet_writer(folder / f"{long.run.id}.parquet", schema) as write:
        for response in pieces:
            rows = waiting.popleft()
            channels = channels_of(response, driven, rows.in_gap)
            columns = {TIME: rows.time_s, "x_in_mm": response.x_in_mm, **channels}
            write(table_of({name: columns[name] for name in names}))
            parts.append(summary_of(response, channels, rows.measured))
            thinned.append(long.thin(rows))
    return _whole(parts), long.thinned(thinned)


def _whole(parts: Sequence[RunSummary]) -> RunSummary:
    """Return the summary of all rows."""
    return RunSummary(
        parts[-1].solver,
        sum(part.rows for part in parts),
        sum(part.slack for part in parts),
        sum(part.unconverged for part in parts),
        {name: sum(part.squares[name] for part in parts) for name in parts[0].squares},
        {name: sum(part.samples[name] for part in parts) for name in parts[0].samples},
    )


def _drives(long: LongRun, waiting: deque[Rows]) -> Iterator[DriveInput]:
    """Yield the drive of each piece of a run; append its rows to `waiting`."""
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
