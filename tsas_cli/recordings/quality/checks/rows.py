"""The checks for rows that are lost or repeated, and for a position that jumps alone."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.noise import third_differences
from tsas_cli.recordings.quality.finding import Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.samples import smallest_change
from tsas_cli.recordings.quality.trial import GAP, RunSignals
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.wording import count_of

_OF_A_STROKE, _LONGEST_S = 0.03, 0.1  # window on each side
_FEWEST_ROWS = 6
_FAR, _SEEN = 8.0, 5.0  # standard deviations, of x_in and of another channel
_SUDDEN, _STEPS = 8.0, 3.0  # noise levels, and steps, that x_in changes by from row to row
_EVEN, _MOSTLY = 0.2, 0.98  # intervals that are even, and most of them
_SAME_SLOPE, _SAME_TIME = 0.4, 0.3  # relative
_OTHERS, _TORN, _WITH_IT = 20, 10.0, 3.0  # changes from row to row, and times the least of them


class _Jumps(NamedTuple):
    """What a channel does between neighbouring rows: its jump and slopes, shape (m,)."""

    jump: Floats
    before: Floats  # slope per second
    after: Floats
    usual: float
    slope_sd: float
    at_once: Floats  # what it changes by between the two rows, beyond the changes beside


def lost_samples(trial: RunSignals) -> Findings:
    """Samples are lost, and the times run on as if none were.

    Where the rows of a lost buffer are closed up, every channel jumps by its slope times the same
    time, and goes on with that slope. A corner of the motion changes the slope, a slipped encoder
    moves one channel alone, and a tendon that slips moves no drive. Reported where x_in and another
    channel jump by the same time from one row to the next, far beyond the noise, and by more than
    from the row before and to the row after. A drive that starts, brakes, or sticks and slips takes
    several rows. Where the slope changes among the lost samples, both jump by many times what they
    do anywhere else.
    """
    interval = np.diff(trial.time_s)
    even = float(np.mean(np.abs(interval / trial.step_s - 1.0) < _EVEN))
    if even < _MOSTLY or float(trial.repeats.mean()) > 1.0 - _MOSTLY:
        yield NotChecked("the times are uneven, or rows repeat")
        return
    step_s = trial.step_s
    window_s = min(_OF_A_STROKE * trial.stroke_s, _LONGEST_S)
    rows = max(round(window_s / step_s), _FEWEST_ROWS)
    moving = {n: v for n, v in trial.mechanical.items() if trial.moves(n) and np.isfinite(v).all()}
    if "x_in_mm" not in moving or len(moving) < 2 or trial.time_s.size < 4 * rows:
        yield NotChecked("too few channels move without a gap")
        return
    jumps = {name: _jumps(values, rows, step_s) for name, values in moving.items()}
    size = trial.sizes["x_in_mm"]
    sudden = np.abs(jumps["x_in_mm"].at_once) > max(_SUDDEN * size.noise, _STEPS * size.step)
    gap = np.convolve(interval > GAP * step_s, np.ones(2 * rows), mode="same") > 0.0
    possible = sudden & ~gap[rows - 1 : rows - 1 + sudden.size]
    places = _places(jumps, rows, possible, 0.5 * step_s)
    if places:
        lost = [lost_s for _, lost_s in places]
        first, lost_s = places[0]
        at = first + rows - 1
        yield warning(
            None,
            f"all channels jump at {count_of(len(places), 'place')}, as if samples were lost and "
            f"the gap closed up: {lost_s:.2g} s at {trial.time_s[at]:.5g} s"
            + (f", {sum(lost):.2g} s in total" if lost[1:] else ""),
            "write down the time of each sample, and look for lost buffers at the source",
            float(trial.time_s[at]),
        )
    rows_of_places = {place + rows - 1 for place, _ in places}
    for at in _torn(trial, list(moving)):
        if all(abs(at - row) > rows for row in rows_of_places):
            yield warning(
                None,
                f"x_in_mm and other channels jump from one row to the next at "
                f"{trial.time_s[at]:.5g} s, as if samples were lost there",
                "write down the time of each sample, and end the run before that time",
                float(trial.time_s[at]),
            )


def _torn(trial: RunSignals, moving: Sequence[str]) -> list[int]:
    """Return the rows after which x_in and another channel jump as nowhere else in the run.

    A jump is what a change differs by from the mean of the changes before and after it.
    """
    other = trial.repeats[1:] | (np.diff(trial.time_s) > GAP * trial.step_s)
    known = np.convolve(other, np.ones(5), mode="same")[1:-1] == 0.0
    jumps, far = {}, {}
    for name in moving:
        steps = np.diff(trial.channels[name])
        jumps[name] = known * np.abs(steps[1:-1] - 0.5 * (steps[:-2] + steps[2:]))
        usual = max(float(np.sort(jumps[name])[-_OTHERS:][0]), trial.sizes[name].step)
        far[name] = jumps[name] > (_TORN if name == "x_in_mm" else _WITH_IT) * usual
    of_drive, beside = jumps["x_in_mm"], np.pad(jumps["x_in_mm"], 1)
    drive = far.pop("x_in_mm") & (of_drive >= beside[:-2]) & (of_drive > beside[2:])
    return [int(row) + 1 for row in np.flatnonzero(drive & np.any(list(far.values()), axis=0))]


def _places(
    jumps: dict[str, _Jumps], rows: int, possible: Mask, least_s: float
) -> list[tuple[int, float]]:
    """Return where samples are lost, and how long that lasted, more than the least [s]."""
    drive = jumps["x_in_mm"]
    slope = 0.5 * (drive.before + drive.after)
    with np.errstate(divide="ignore", invalid="ignore"):
        lost_s = drive.jump / slope
        steady = np.abs(drive.after - drive.before) < _SAME_SLOPE * np.abs(slope)
    found: list[tuple[int, float]] = []
    sudden = np.abs(drive.at_once - drive.jump) < _SAME_TIME * np.abs(drive.jump) + drive.usual
    far = np.where(
        possible & steady & sudden & (lost_s > least_s), np.abs(drive.jump) / drive.usual, 0.0
    )
    for place in np.argsort(-far):
        if far[place] < _FAR:
            break
        if any(abs(place - other) <= 2 * rows for other, _ in found):
            continue
        if _of_all(jumps, int(place), float(lost_s[place])):
            found.append((int(place), float(lost_s[place])))
    return sorted(found)


def _of_all(jumps: dict[str, _Jumps], place: int, lost_s: float) -> bool:
    """Return whether every other channel jumps by the same time, and one of them visibly."""
    seen = False
    for name, (jump, before, after, usual, slope_sd, at_once) in jumps.items():
        if name == "x_in_mm":
            continue
        ends = sorted((lost_s * before[place], lost_s * after[place]))
        slack = _SEEN * (usual + lost_s * slope_sd) + _SAME_TIME * max(abs(ends[0]), abs(ends[1]))
        if not ends[0] - slack <= jump[place] <= ends[1] + slack:
            return False
        sudden = abs(at_once[place] - jump[place]) < _SAME_TIME * abs(jump[place]) + 3.0 * usual
        seen = seen or bool(sudden and abs(jump[place]) > _SEEN * usual)
    return seen


def _jumps(values: Floats, rows: int, step_s: float) -> _Jumps:
    """Return the jumps of a channel between parabolas through the rows before and after."""
    at = np.arange(-rows, 0) + 0.5
    fit = np.linalg.pinv(np.vander(at, 3))  # the last row gives the value, the one before the slope
    windows = np.lib.stride_tricks.sliding_window_view(values, rows)
    left, right = windows[:-rows], windows[rows:, ::-1]
    jump = right @ fit[2] - left @ fit[2]
    change = np.diff(values)[rows - 2 : rows + jump.size]
    between = change[1:-1]
    at_once = between - np.clip(between, *np.sort((change[:-2], change[2:]), axis=0))
    usual = 1.4826 * float(np.median(np.abs(jump - np.median(jump))))
    before, after = left @ fit[1] / step_s, -(right @ fit[1]) / step_s
    slope_sd = 1.05 * float(np.median(np.abs(after - before)))  # of one side
    return _Jumps(jump, before, after, max(usual, 1e-12), slope_sd, at_once)


_BLOCK = 32  # rows
_MEDIAN = 0.6745  # of |noise| of unit deviation


def repeated_rows(trial: RunSignals) -> Findings:
    """Rows repeat the row before them in every channel.

    The logger sampled faster than the sensors, or repeated the last value while the link was down.
    Noise makes an exact repeat unlikely; its probability follows, block by block, from each
    channel's noise and its smallest change. Reported are repeats far beyond that, in blocks where
    the noise of some channel exceeds its smallest change: quiet channels repeat by chance.
    """
    if not trial.channels:
        yield NotChecked("no column besides time holds enough numbers")
        return
    repeated = trial.repeats.copy()
    if not repeated.any():
        return
    block = (np.cumsum(~repeated) - 1) // _BLOCK  # a repeat belongs to the row that it repeats
    chance = _chances(trial, ~repeated)[block]
    noisy = chance < 1.0
    if not noisy.any():
        yield NotChecked("the channels are so quiet or so coarse that rows repeat by chance")
        return
    repeated &= noisy
    count, expected = int(repeated.sum()), float(chance[noisy].sum())
    if count > 3.0 * expected + 10.0:
        yield warning(
            None,
            f"{count} of {repeated.size} rows ({100 * count / repeated.size:.2g} %) repeat the row "
            f"before them in all channels; with this noise about {expected:.0f} would",
            "record no faster than the slowest sensor, or set drop_repeated_rows in the map",
            first_s=float(trial.time_s[np.argmax(repeated)]),
        )


def _chances(trial: RunSignals, fresh: Mask) -> Floats:
    """Return the probability that a row equals the preceding one, for each block of fresh rows.

    It is the largest of a block and its two neighbours, for blocks at the edge of a rest. A channel
    whose noise is below its smallest change repeats for certain.
    """
    chance = np.ones(-(-int(fresh.sum()) // _BLOCK))
    for values in (channel[fresh] for channel in trial.channels.values()):
        smallest = smallest_change(values)
        third = np.zeros(chance.size * _BLOCK)
        third[: max(values.size - 3, 0)] = np.nan_to_num(np.abs(third_differences(values)))
        noise = np.median(third.reshape(-1, _BLOCK), axis=1) / _MEDIAN
        repeats = smallest / (2.0 * math.sqrt(math.pi) * noise + 1e-300)
        chance *= np.where(noise > smallest, repeats, 1.0)
    padded = np.pad(chance, 1, mode="edge")
    return np.maximum(chance, np.maximum(padded[:-2], padded[2:]))


_FARTHEST, _LOUDEST = 10.0, 20.0  # times the largest step elsewhere, and noise levels
_QUIET = 3.0  # times the largest step elsewhere, of a channel that does not jump
_BESIDE = 2  # rows


def jump(trial: RunSignals) -> Findings:
    """A position jumps from one row to the next and stays there, and no other channel jumps.

    An encoder was reset, its counter overflowed, or its cable was off for a moment. Reported where
    x_in or x_out changes by ten times its largest change elsewhere, 20 times its noise and three
    quantisation steps, while all other channels change as they do elsewhere. Not reported: an
    outlier, which comes back; a drive that jumps, which the tension follows; a tendon that slips
    many times. A jump within the usual changes is a fault that `diagnose` names.
    """
    channels = {name: trial.steps(name) for name in trial.mechanical}
    for name in ("x_in_mm", "x_out_mm"):
        if name not in channels:
            continue
        if len(channels) < 2:
            yield NotChecked("no other channel shows whether the tendon moved")
            continue
        at = int(np.argmax(channels[name]))
        beside = slice(max(at - _BESIDE, 0), at + _BESIDE + 1)
        size, elsewhere = channels[name][at], _elsewhere(channels[name], beside)
        sizes = trial.sizes[name]
        least = max(_FARTHEST * elsewhere, _LOUDEST * sizes.noise, _STEPS * sizes.step)
        others = [steps for other, steps in channels.items() if other != name]
        alone = all(steps[beside].max() <= _QUIET * _elsewhere(steps, beside) for steps in others)
        if size > least and alone:
            before, after = trial.channels[name][at : at + 2]
            yield error(
                name,
                f"{name} jumps from {before:.6g} to {after:.6g} mm at {trial.time_s[at + 1]:.6g} "
                f"s, row {trial.first_row + at + 1}, and no other channel jumps there",
                "check the encoder, its counter and its cable; record again, or end the run before",
                float(trial.time_s[at + 1]),
            )


def _elsewhere(steps: Floats, beside: slice) -> float:
    """Return the largest change, but for those beside a row."""
    rest = steps.copy()
    rest[beside] = 0.0
    return float(rest.max(initial=0.0))
