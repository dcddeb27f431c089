"""A run that is too long for memory, prepared for a model: row by row, or thinned for a fit.

A model of friction depends on the path alone. So a fit loses no physics when it uses every 64th
sample and those at reversals: the drive is cleaned with all its samples before, and the noise level
is that of all of them.
"""

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pyarrow as pa

from tsas_cli.identification.comparison import RunSummary, channels_of, refuse_invalid, summary_of
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import (
    CHANNELS,
    GAP,
    START_SAMPLES,
    Prepared,
    drive_of,
    driving_columns,
    is_empty,
    nothing_to_compare,
)
from tsas_cli.numerics.conditioning_pieces import (
    Aligned,
    Cleaned,
    CleaningPlan,
    Samples,
    cleaned,
    joined,
    plan,
)
from tsas_cli.numerics.noise import Noise, noise_of
from tsas_cli.physics.by_pieces import simulate_pieces
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings import pieces as reading
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import long_run, pieces
from tsas_cli.recordings.recording import NONE_COPIED, CopiedRows
from tsas_cli.recordings.run_files import RunColumns
from tsas_cli.recordings.session import seconds_into
from tsas_cli.recordings.writing import parquet_writer, table_of
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError

FEW = 16  # samples of a stroke, below which no transition is detected (`phases`)
OVERLAP_SHARE = 1 / 16  # of a piece: rows at its ends that only support the cleaning of others


@dataclass(frozen=True)
class Rows:
    """Consecutive rows of a run: cleaned inputs of a model, and measured channels to compare."""

    start: int
    time_s: Floats
    cleaned: Mapping[str, Cleaned]
    measured: Mapping[str, Floats]
    in_gap: Mask


@dataclass(frozen=True)
class LongRun:
    """A run that is read in pieces: inputs, compared channels, and estimates for the whole run."""

    run: Run
    columns: RunColumns
    drive_column: str
    plans: Mapping[str, CleaningPlan]
    noise: Mapping[str, Noise]
    session_s: float
    copied: CopiedRows = NONE_COPIED  # from another run

    @property
    def every(self) -> int:
        """The thinning: one in so many samples."""
        return -(-self.columns.rows // reading.MOST_ROWS)

    def rows(self) -> Iterator[Rows]:
        """Yield the cleaned rows of the run in order, a piece at a time."""
        overlap = int(OVERLAP_SHARE * reading.MOST_ROWS)
        streams = {
            name: Aligned(cleaned(_samples(self.columns, name, 2 * overlap), overlap, known))
            for name, known in self.plans.items()
        }
        for piece in pieces(self.columns, [TIME, *self.noise]):
            parts = {name: stream.take(piece.rows) for name, stream in streams.items()}
            in_gap = [part.apart_s > GAP * self.plans[n].interval_s for n, part in parts.items()]
            copied_mask = self.copied.mask(piece.start, piece.stop)
            measured = {n: np.where(copied_mask, math.nan, piece.columns[n]) for n in self.noise}
            yield Rows(piece.start, piece.columns[TIME], parts, measured, np.any(in_gap, axis=0))

    def prepared(self) -> Prepared:
        """Return the run, cleaned and thinned for a fit."""
        return self.thinned([self.thin(rows) for rows in self.rows()])

    def thinned(self, thinned_rows: Sequence[Rows]) -> Prepared:
        """Return the run for a fit, from the rows returned by `thin`."""
        time_s = np.concatenate([rows.time_s for rows in thinned_rows])
        conditioned = {
            name: joined([rows.cleaned[name] for rows in thinned_rows], known, time_s.size)
            for name, known in self.plans.items()
        }
        measured = {
            n: np.concatenate([rows.measured[n] for rows in thinned_rows]) for n in self.noise
        }
        in_gap = np.concatenate([rows.in_gap for rows in thinned_rows])
        return Prepared(
            self.run,
            time_s,
            self.drive_column,
            conditioned,
            measured,
            in_gap,
            self.session_s,
            self.every,
            self.columns.rows,
            self.noise,
        )

    def thin(self, rows: Rows) -> Rows:
        """Return the rows that a fit uses; reversals become indices into them."""
        numbers = np.arange(rows.start, rows.start + rows.time_s.size)
        mask = (numbers % self.every == 0) | (numbers < START_SAMPLES)
        mask |= numbers == self.columns.rows - 1
        for part in rows.cleaned.values():
            mask[part.reversals - rows.start] = True
        kept = numbers[mask]
        parts = {
            name: Cleaned(rows.start, part.samples[:, mask], np.searchsorted(kept, part.reversals))
            for name, part in rows.cleaned.items()
        }
        measured = {name: values[mask] for name, values in rows.measured.items()}
        return Rows(rows.start, rows.time_s[mask], parts, measured, rows.in_gap[mask])


def open_long(
    dataset: Dataset,
    run: Run,
    session_start: datetime | None,
    copied: CopiedRows = NONE_COPIED,
) -> LongRun | None:
    """Return a run that is too long for memory, without its `copied` rows; else None.

    InputError: as from `prepare`.
    """
    columns = long_run(dataset.folder, run)
    if columns is None:
        return None
    names = columns.known
    driving = driving_columns(run, names)
    count = -(-columns.rows // reading.MOST_ROWS)
    plans = {name: plan(_samples(columns, name, 0), count) for name in driving}
    for name, known in plans.items():
        if not known.interval_s > 0.0:
            raise is_empty(run, name)
    noise = _noise(columns, [n for n in CHANNELS if n in names and n not in driving])
    if not noise:
        raise nothing_to_compare(run, names)
    session_s = seconds_into(session_start, run.started)
    return LongRun(run, columns, driving[0], plans, noise, session_s, copied)


def thinned_notes(runs: Sequence[Prepared]) -> list[str]:
    """Return a sentence for each run that a fit uses in part only."""
    out = []
    for run in (run for run in runs if run.every > 1):
        strokes = run.conditioned[run.drive_column].reversals.size - 1
        note = (
            f"Run {run.run.id} has {run.all_rows} samples: the fit uses one in {run.every} of "
            "them, and those at reversals of the drive."
        )
        if run.time_s.size < FEW * strokes:
            note += (
                f" A stroke keeps {run.time_s.size / strokes:.2g} of its samples, too few to "
                "detect its phases."
            )
        out.append(note)
    return out


def _noise(run: RunColumns, names: Sequence[str]) -> dict[str, Noise]:
    """Return the noise of each channel with any finite value: the median over the pieces."""
    found: dict[str, list[Noise]] = {name: [] for name in names}
    for piece in pieces(run, [TIME, *names]) if names else ():
        for name in names:
            if np.isfinite(piece.columns[name]).any():
                found[name].append(noise_of(piece.columns[name], piece.columns[TIME]))
    known = {n: [one for one in found[n] if not math.isnan(one.sd)] for n in names if found[n]}
    return {
        n: Noise(*map(float, np.median(levels, axis=0))) if levels else Noise(math.nan)
        for n, levels in known.items()
    }


def _samples(run: RunColumns, name: str, overlap: int) -> Iterator[Samples]:
    for piece in pieces(run, [TIME, name], overlap=overlap):
        yield piece.start, piece.columns[TIME], piece.columns[name]


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
    whole = RunSummary(
        parts[-1].solver,
        sum(part.rows for part in parts),
        sum(part.slack for part in parts),
        sum(part.unconverged for part in parts),
        {name: sum(part.squares[name] for part in parts) for name in parts[0].squares},
        {name: sum(part.samples[name] for part in parts) for name in parts[0].samples},
    )
    return whole, long.thinned(thinned)


def _drives(long: LongRun, waiting: deque[Rows]) -> Iterator[DriveInput]:
    """Yield the drive of each piece of a run; append its rows to `waiting`."""
    begin_s = 0.0
    for rows in long.rows():
        if rows.start == 0:
            begin_s = float(rows.time_s[0])
        waiting.append(rows)
        drive = drive_of(
            long.run,
            rows.time_s,
            long.drive_column,
            {name: part.values for name, part in rows.cleaned.items()},
            f_in_N=rows.measured.get("f_in_N") if rows.start == 0 else None,
            session_s=long.session_s,
        )
        yield replace(drive, time_s=rows.time_s - begin_s)
