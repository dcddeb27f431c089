"""A recording prepared for a model: conditioned drive, noise levels, gaps."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property

import numpy as np

from tsas_cli.numerics.conditioning import METHOD, Conditioned, condition
from tsas_cli.numerics.noise import Noise, noise_of, recorded
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import TOLERANCE
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Load, Run
from tsas_cli.recordings.recording import NONE_COPIED, CopiedRows, Recording
from tsas_cli.recordings.session import seconds_into
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError

CHANNELS = ("f_in_N", "f_out_N", "x_out_mm")  # predicted by the models, unless they drive them
LOAD_COLUMNS: Mapping[Load, str] = {"force": "f_out_N", "displacement": "x_out_mm"}
GAP = 1.5  # times the median time between a column's samples
HIDDEN = 0.03  # error of f_in by a step, over its noise; all steps together stay below a third
FINEST_TOLERANCE = 1e-7  # of a step of the dynamic chain
MOTOR = "motor_angle_rad"
MOST_UNEXPLAINED = 0.2  # of x_in's standard deviation, by the angle of a motor that drives it
START_SAMPLES = 20  # for the tension at the start


@dataclass(frozen=True)
class Prepared:
    """One run: conditioned inputs of a model, and measured channels to compare.

    Of a run that is too long for memory it has one in `every` of `all_rows` samples, those at
    reversals of the drive, and `all_noise`, the noise of all samples. `temperature_C` is from
    the lowest to the highest, `motor_mm` the motor's angle in displacement of the drive, shape
    (n,), where they were recorded.
    """

    run: Run
    time_s: Floats
    drive_column: str
    conditioned: Mapping[str, Conditioned]
    measured: Mapping[str, Floats]
    in_gap: Mask
    session_s: float = 0.0  # start of the run since the dataset's first
    every: int = 1
    all_rows: int = 0
    all_noise: Mapping[str, Noise] | None = None
    temperature_C: tuple[float, float] | None = None
    motor_mm: Floats | None = None

    @cached_property
    def drive(self) -> DriveInput:
        """The given quantities at the ends, conditioned."""
        return drive_of(
            self.run,
            self.time_s,
            self.drive_column,
            {name: column.values for name, column in self.conditioned.items()},
            f_in_N=self.measured.get("f_in_N"),
            session_s=self.session_s,
            motor_mm=self.motor_mm,
        )

    @cached_property
    def noise(self) -> dict[str, float]:
        """Noise level of each measured channel, with quantisation [the channel's unit].

        Zero where a channel never changes, NaN where there are too few samples.
        """
        return {name: noise.sd for name, noise in self.noises.items()}

    @cached_property
    def noises(self) -> dict[str, Noise]:
        """Noise of each measured channel with its memory, from sample to sample of these."""
        if self.all_noise is None:
            return {n: noise_of(values, self.time_s) for n, values in self.measured.items()}
        of_all = {name: self.all_noise[name] for name in self.measured}
        return {
            name: one._replace(correlation=one.correlation**self.every)
            for name, one in of_all.items()
        }

    @cached_property
    def step_tolerance(self) -> float:
        """Tolerance of a step of the dynamic chain, over the tension, below the noise of f_in."""
        noise, f_in = self.noise.get("f_in_N", math.nan), self.measured.get("f_in_N")
        if f_in is None or not noise > 0.0:
            return TOLERANCE
        hidden = HIDDEN * noise / float(np.nanmax(np.abs(f_in)))
        return min(max(hidden, FINEST_TOLERANCE), TOLERANCE)

    @property
    def has_force(self) -> bool:
        """Whether a force was measured, whether it drives an end or not."""
        return any(name.endswith("_N") for name in (*self.measured, *self.conditioned))

    def channel(self, name: str) -> Floats | None:
        """Return a column, conditioned if it drives the model, else as measured, or None."""
        conditioned = self.conditioned.get(name)
        return self.measured.get(name) if conditioned is None else conditioned.values

    def conditioning(self) -> dict[str, dict[str, object]]:
        """Return the record of each driving column's conditioning."""
        return {
            name: {
                "method": METHOD if c.noise > 0.0 else "none: the column has no noise",
                "window_s": c.window_s,
                "noise": c.noise,
                "unit": BY_NAME[name].unit,
                "reversals": max(c.reversals.size - 2, 0),
            }
            for name, c in self.conditioned.items()
        }


def drive_of(
    run: Run,
    time_s: Floats,
    drive_column: str,
    conditioned: Mapping[str, Floats],
    *,
    f_in_N: Floats | None,
    session_s: float,
    motor_mm: Floats | None = None,
) -> DriveInput:
    """Return the drive of a run: the conditioned column at the drive and, where given, at the load.

    The measured tension at the drive, unless it is given, is the initial condition.
    """
    by_force, load = drive_column == "f_in_N", LOAD_COLUMNS.get(run.load)
    start = None if f_in_N is None or by_force else _start_value(time_s, f_in_N)
    return DriveInput(
        values=conditioned[drive_column],
        kind="force" if by_force else "displacement",
        load=run.load,
        load_values=None if load is None else conditioned[load],
        start_f_in_N=start,
        time_s=time_s - time_s[0],
        session_s=session_s,
        motor_mm=motor_mm,
    )


def prepare(
    recording: Recording,
    session_start: datetime | None = None,
    copied: CopiedRows = NONE_COPIED,
) -> Prepared:
    """Return a run with conditioned driving columns and the measured channels to compare.

    `session_start` is the start of the dataset's first run, where the manifest has it. Measurements
    in rows that are `copied` from another run are left out.

    InputError: the run has no column that can drive the tendon, lacks the one that drives its load,
    or has no channel to compare a model with.
    """
    run, columns = recording.run, recording.columns
    driving = driving_columns(run, list(columns))
    time_s = np.array(recording.time_s)  # a copy, as kernels compile anew for read-only arrays
    for name in driving:
        if np.isfinite(columns[name]).sum() < 2:
            raise is_empty(run, name)
    columns = {n: recorded(values) for n, values in columns.items() if n in (*driving, *CHANNELS)}
    copied_rows = copied.mask(0, time_s.size)
    columns |= {
        n: np.where(copied_rows, math.nan, v) for n, v in columns.items() if n not in driving
    }
    gap = np.any([_in_gap(time_s, columns[name]) for name in driving], axis=0)
    measured = {
        n: columns[n]
        for n in CHANNELS
        if n in columns and n not in driving and np.isfinite(columns[n][~gap]).any()
    }
    if not measured:
        raise nothing_to_compare(run, list(recording.columns))
    conditioned = {name: condition(time_s, columns[name]) for name in driving}
    session_s = seconds_into(session_start, run.started)
    return Prepared(
        run,
        time_s,
        driving[0],
        conditioned,
        measured,
        gap,
        session_s,
        temperature_C=_span(recording.columns.get("temperature_C")),
        motor_mm=_motor(time_s, recording.columns.get(MOTOR), conditioned.get("x_in_mm")),
    )


def _motor(time_s: Floats, angle: Floats | None, x_in: Conditioned | None) -> Floats | None:
    """Return the motor's angle in displacement of the drive, conditioned, shape (n,) [mm].

    The transmission is the slope of x_in over the angle. None where the angle was not recorded over
    the whole run, or does not drive x_in.
    """
    if angle is None or x_in is None or not np.isfinite(angle).all() or np.ptp(angle) == 0.0:
        return None
    turned = condition(time_s, np.array(angle)).values
    slope = np.polyfit(turned - turned.mean(), x_in.values, 1)[0]
    left = x_in.values - slope * turned
    if float(left.std()) > MOST_UNEXPLAINED * float(x_in.values.std()):
        return None
    driven: Floats = slope * turned
    return driven


def _span(values: Floats | None) -> tuple[float, float] | None:
    """Return the lowest and the highest value, None where there is none."""
    finite = np.empty(0) if values is None else values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else None


def driving_columns(run: Run, columns: Sequence[str]) -> list[str]:
    """Return the columns that drive the tendon, and its load where it is driven.

    InputError: a driving column is missing, or both ends have a given force.
    """
    drive = next((name for name in ("x_in_mm", "f_in_N") if name in columns), None)
    if drive is None:
        raise InputError(
            "no column drives the tendon",
            where=run.file,
            expected="x_in_mm or f_in_N",
            remedy=f"there are: {', '.join(columns)}",
        )
    load = LOAD_COLUMNS.get(run.load)
    if load is not None and load not in columns:
        raise InputError(
            f"load = {run.load!r} needs the column {load}",
            where=run.file,
            remedy="record it, or set load = 'spring' in dataset.toml",
        )
    if drive == "f_in_N" and run.load == "force":
        raise InputError(
            "forces at both ends do not determine the motion of the tendon",
            where=run.file,
            expected="x_in_mm",
        )
    return [drive] if load is None else [drive, load]


def is_empty(run: Run, column: str) -> InputError:
    """Return the error for a driving column without numbers."""
    return InputError(f"column {column} is empty", where=run.file, expected="numbers")


def nothing_to_compare(run: Run, columns: Sequence[str]) -> InputError:
    """Return the error for a run without a channel that a model could predict."""
    return InputError(
        "nothing to compare a model with",
        where=run.file,
        expected=f"one of {', '.join(CHANNELS)} besides the driving columns",
        remedy=f"there are: {', '.join(columns)}",
    )


def _in_gap(time_s: Floats, values: Floats) -> Mask:
    """Return which rows of a column lie in a gap longer than its sampling interval."""
    finite = np.flatnonzero(np.isfinite(values))
    rows = np.arange(values.size)
    before = np.searchsorted(finite, rows, side="right") - 1
    after = np.searchsorted(finite, rows)
    inside = (before >= 0) & (after < finite.size)
    gap_s = (
        time_s[finite[np.minimum(after, finite.size - 1)]] - time_s[finite[np.maximum(before, 0)]]
    )
    return ~inside | (gap_s > GAP * np.median(np.diff(time_s[finite])))


def _start_value(time_s: Floats, values: Floats) -> float | None:
    """Return the value at the first sample, from a line through the first few."""
    finite = np.flatnonzero(np.isfinite(values[:START_SAMPLES]))
    if finite.size < 2:
        return None
    slope_and_value = np.polyfit(time_s[finite] - time_s[0], values[finite], 1)
    return float(slope_and_value[1])
