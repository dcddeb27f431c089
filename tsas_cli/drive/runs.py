"""Checked recordings of a drive: motor speed in, end of the tendon out; their response (H1)."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tsas_cli.numerics.linear_response import Hold, Sampled, sampled
from tsas_cli.numerics.noise import FEWEST_SAMPLES as FEWEST_OF_NOISE
from tsas_cli.numerics.noise import interpolated, noise_sd
from tsas_cli.recordings.recording import NONE_COPIED, CopiedRows, Recording
from tsas_cli.support.arrays import Complex, Floats, Mask
from tsas_cli.support.errors import InputError

FEWEST_SAMPLES = 500
UNEVEN = 0.02  # of a sampling step, by which another one may differ
# Of a run, for the noise level; the median one is not where the drive swings fastest.
STRETCHES = 40
AT_REST = 0.01  # of the largest speed
MOVED = 5.0  # times the noise, that x_in has to travel
RPM_PER_RAD_S = 30.0 / math.pi
FOLLOWS = 0.5  # correlation of travel and turns below which x_in is not what the motor moves


@dataclass(frozen=True)
class DriveRun:
    """One run: the motor's speed [rpm] on an even clock, x_in and its noise [mm], shapes (n,)."""

    id: str
    u: Sampled
    x_in: Floats
    noise_mm: float
    at_rest: bool  # when it begins
    copied: CopiedRows = NONE_COPIED  # from another run

    @cached_property
    def counts(self) -> Mask:
        """Which samples are no copies, shape (n,)."""
        return ~self.copied.mask(0, self.x_in.size)

    @property
    def longest(self) -> slice:
        """The longest stretch of samples that count."""
        edges = np.flatnonzero(np.diff(self.counts, prepend=False, append=False)).reshape(-1, 2)
        first, end = edges[np.argmax(np.diff(edges, axis=1))]
        return slice(int(first), int(end))

    @property
    def time_s(self) -> Floats:
        """Time since the first sample [s]."""
        return np.asarray(self.u.step_s * np.arange(self.x_in.size), dtype=np.float64)


def drive_runs(
    recordings: Iterable[Recording], hold: Hold, copied: Mapping[str, CopiedRows] | None = None
) -> list[DriveRun]:
    """Return the runs of a dataset, some of whose rows may be `copied` from other runs.

    InputError: a channel is missing, has a gap, does not move or keeps one speed; the clock is
    uneven; a run is too short; or x_in does not follow the motor.
    """
    known = copied or {}
    return [_checked(one, hold, known.get(one.run.id, NONE_COPIED)) for one in recordings]


def _checked(recording: Recording, hold: Hold, copied: CopiedRows) -> DriveRun:
    where = recording.run.file
    time_s, x = recording.time_s, _channel(recording, "x_in_mm")
    if time_s.size < FEWEST_SAMPLES:
        raise InputError(
            f"{time_s.size} samples are too few",
            where=where,
            expected=f"at least {FEWEST_SAMPLES}",
            remedy="record longer, or leave the run out with --runs",
        )
    step = (float(time_s[-1]) - float(time_s[0])) / (time_s.size - 1)
    uneven = np.flatnonzero(np.abs(np.diff(time_s) / step - 1.0) > UNEVEN)
    if uneven.size:
        k = int(uneven[0])
        raise InputError(
            f"time_s goes on by {time_s[k + 1] - time_s[k]:.4g} s, by {step:.4g} s on average",
            where=f"{where}, row {k + 1}",
            expected="an even clock",
            remedy="cut the run there, or resample it before ingest",
        )
    if "motor_angle_rad" in recording.columns and "motor_speed_rpm" not in recording.columns:
        angle = _channel(recording, "motor_angle_rad")
        u = np.asarray(np.gradient(angle, step) * RPM_PER_RAD_S)
    else:
        u = _channel(recording, "motor_speed_rpm")
    if float(np.ptp(u)) == 0.0:
        still = u[0] == 0.0
        raise InputError(
            "the motor stands still" if still else f"the motor keeps one speed, {u[0]:.4g} rpm",
            where=where,
            expected="a motor_speed_rpm that changes",
            remedy="record a chirp, steps or sines, or leave the run out with --runs",
        )
    noise = _noise(x[~interpolated(x)])
    if float(np.ptp(x)) <= MOVED * noise:
        raise InputError(
            f"x_in_mm does not move (noise {noise:.2g} mm)",
            where=where,
            expected="a drive that moves the tendon",
            remedy="leave the run out with --runs, or mend the sensor",
        )
    run = DriveRun(
        recording.run.id,
        sampled(step, u, hold),
        x,
        noise if noise > 0.0 else 1e-6 * float(np.ptp(x)),
        bool(abs(u[0]) <= AT_REST * np.abs(u).max()),
        copied,
    )
    _refuse_unrelated(run, where)
    return run


def _channel(recording: Recording, name: str) -> Floats:
    values = recording.get(name)
    if values is None:
        raise InputError(
            f"column {name} is missing",
            where=recording.run.file,
            expected="motor_speed_rpm or motor_angle_rad, and x_in_mm, as a drive's recording has",
            remedy=f"there are: {', '.join(recording.columns)}; leave the run out with --runs",
        )
    gaps = np.flatnonzero(~np.isfinite(values))
    if gaps.size:
        raise InputError(
            f"{name} has {gaps.size} gap{'s' if gaps.size > 1 else ''}",
            where=f"{recording.run.file}, row {gaps[0]}",
            expected="a value in each row: the drive remembers what was asked of it",
            remedy="cut the run before the gap",
        )
    return np.array(values)  # a copy, as kernels compile anew for read-only arrays


def _noise(values: Floats) -> float:
    stretches = max(1, min(STRETCHES, values.size // FEWEST_OF_NOISE))
    return float(np.median([noise_sd(part) for part in np.array_split(values, stretches)]))


def _refuse_unrelated(run: DriveRun, where: str) -> None:
    """Stop where x_in is not what the motor's turns make of it, whatever the lags."""
    time = run.time_s - run.time_s.mean()
    turns, travel = (_without_line(time, v) for v in (run.u.integral, run.x_in))
    together = float(turns @ travel) / max(float(np.linalg.norm(turns)), 1e-300)
    follows = together / max(float(np.linalg.norm(travel)), 1e-300)
    if follows < FOLLOWS:
        turned = " but its opposite" if follows < -FOLLOWS else ""
        raise InputError(
            f"x_in_mm does not follow the turns of the motor{turned} (correlation {follows:.2f})",
            where=where,
            expected="an x_in_mm that goes with the integral of motor_speed_rpm",
            remedy="are columns, signs or runs exchanged? see the map of `tsas ingest`",
        )


def _without_line(time: Floats, values: Floats) -> Floats:
    centred = values - values.mean()
    line: Floats = centred - time * float(time @ centred) / float(time @ time)
    return line


SEGMENTS = 10.0  # of the longest run: long ones show low frequencies, many show coherence
LONGEST_S = 5.0
COHERENT = 0.8
POWER = 1e-5  # of the largest power of the input, below which it says nothing


@dataclass(frozen=True)
class FrequencyResponse:
    """H1 = S_ux/S_uu over frequency [mm per rpm s], its coherence, and where both tell, (m,)."""

    frequency_Hz: Floats
    response: Complex
    coherence: Floats
    excited: Mask

    @property
    def band(self) -> tuple[float, float] | None:
        """Lowest and highest frequency that the input shows, None where there is none."""
        at = self.frequency_Hz[self.excited]
        return (float(at[0]), float(at[-1])) if at.size else None


def frequency_response(runs: Sequence[DriveRun]) -> FrequencyResponse:
    """Return the response that all runs show together, in segments that overlap by half.

    x_in drifts while the motor turns one way: each segment loses its straight line. Of a run that
    shares samples with another one the longest stretch that counts is taken, if that is long enough
    for a run.
    """
    from scipy.signal import csd, welch

    whole = [
        (run, stretch)
        for run, stretch in ((run, run.longest) for run in runs)
        if run.counts.all() or stretch.stop - stretch.start >= FEWEST_SAMPLES
    ]
    lasts_s = [run.u.step_s * (s.stop - s.start - 1) for run, s in whole]
    segment_s = min(LONGEST_S, max(lasts_s) / SEGMENTS, *(lasts / 2.0 for lasts in lasts_s))
    sums: list[Complex] = []
    bins = min(round(segment_s / run.u.step_s) for run, _ in whole) // 2
    for (run, stretch), lasts in zip(whole, lasts_s, strict=True):
        n = round(segment_s / run.u.step_s)
        how = {"fs": 1.0 / run.u.step_s, "nperseg": n, "detrend": "linear"}
        u, x_in = run.u.values[stretch], run.x_in[stretch]
        spectra = (welch(u, **how)[1], csd(u, x_in, **how)[1], welch(x_in, **how)[1])
        sums.append(lasts * np.array([s[1:bins] for s in spectra]))
    uu, ux, xx = np.sum(sums, axis=0)
    frequency = np.arange(1, bins) / segment_s
    coherence = np.abs(ux) ** 2 / np.maximum(np.abs(uu * xx), 1e-300)
    excited = (coherence > COHERENT) & (np.abs(uu) > POWER * np.abs(uu).max())
    # One bin that is coherent by chance is no band.
    excited &= np.convolve(excited, np.ones(3), mode="same") > 1.0
    response = ux / np.where(np.abs(uu) > 0.0, uu, 1.0)
    return FrequencyResponse(frequency, response, np.real(coherence), excited)
