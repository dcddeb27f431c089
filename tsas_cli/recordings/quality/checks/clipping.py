"""The check of a channel that stays at the end of its range while the motion goes on."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error
from tsas_cli.recordings.quality.samples import plateaus
from tsas_cli.recordings.quality.trial import RunSignals, Stroke
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import count_of

_FEWEST_ROWS = 5
_TRAVEL = 0.05  # of the drive's span
_LONG = 0.8  # of that span: strokes that are compared with what a line foretells
_BEFORE, _LAST = (0.5, 0.8), 0.93  # shares of such a stroke
_FOLLOWS = 0.3  # of the channel's span, that it changes by over a stroke at least
_FLAT = 0.25  # slope at the end over that before
_NEAR, _FEWEST_STROKES, _MOST_OF_THEM = 2.0, 2, 0.7
_MOVES_LATE = 3.0  # times as far as before it moves what the drive sets into motion at last
_DEGREE = 5  # of the path over time in the second half of a stroke
_OUTLIERS = 0.01  # share of all samples, that may lie beyond the end of the range
_STRAIGHT = 1.0 / 3.0  # of what is visible: the RMS about a line, twice the noise
_CLIPPED_REMEDY = "raise the sensor's range or lower its gain, check for a stop, and record again"


def clipped(trial: RunSignals) -> Findings:
    """A channel sits at its highest or lowest value while the motion goes on.

    The sensor or its amplifier is at the end of its range, or the part is at a stop. Reported when
    the channel stays constant at its extreme while the drive moves on by more than a twentieth of
    its span. Not clipping: a dwell (everything rests), the dead band after a reversal (the drive
    moves back), a coarse step at the peak of a sine, a rest at the beginning, a slack tendon, whose
    load rests while the drive moves on. With noise behind the end of the range, or a soft end,
    nothing is constant: then the end of each long stroke is a flat line but for noise, and lacks
    what the stroke before it foretells. A force that falls with the speed is curved there.
    """
    for name in trial.mechanical:
        if name == trial.prescribed:
            yield NotChecked(f"{name} is prescribed by the load, and may stay at its extremes")
            continue
        if trial.sizes[name].lowest == trial.sizes[name].highest:
            continue
        for end, sign in (("highest", 1), ("lowest", -1)):
            exact = list(_clipping(trial, name, end, sign))
            yield from exact or _saturation(trial, name, end, sign)


def _clipping(trial: RunSignals, name: str, end: str, sign: int) -> Iterator[Finding]:
    values = trial.channels[name]
    extreme = trial.sizes[name].highest if sign > 0 else trial.sizes[name].lowest
    flat = [
        rows
        for rows in plateaus(values, _FEWEST_ROWS)
        if rows.start > 0
        and values[rows.start] == extreme
        and not (sign < 0 and trial.is_slack(rows))
        and _motion_continues(trial, name, rows, sign)
    ]
    if flat:
        seconds = sum(trial.time_s[r.stop - 1] - trial.time_s[r.start] for r in flat)
        yield error(
            name,
            f"{name} stays at its {end} value {extreme:.6g} for {seconds:.3g} s in "
            f"{count_of(len(flat), 'plateau')} while the motion goes on",
            _CLIPPED_REMEDY,
            float(trial.time_s[flat[0].start]),
        )


def _saturation(trial: RunSignals, name: str, end: str, sign: int) -> Iterator[Finding]:
    """Yield that a channel ends at a level, with noise on it, in all strokes that reach there."""
    strokes = [s for s in trial.strokes if s.direction == sign]
    ends = [_end_of_stroke(trial, name, s) for s in strokes] if name != "x_in_mm" else []
    flat = [(level, lacks) for level, lacks, at_end in filter(None, ends) if at_end]
    if not flat:
        return
    level = sign * max(sign * level for level, _ in flat)
    beyond = sign * (trial.channels[name] - level) > trial.visible(name)
    if np.mean(beyond) > _OUTLIERS:  # no sensor reads more than the end of its range
        return
    near = [e for e in filter(None, ends) if abs(e[0] - level) < _NEAR * trial.visible(name)]
    lacks = [e[1] for e in near if e[2]]
    if len(lacks) >= max(_FEWEST_STROKES, _MOST_OF_THEM * len(near)):
        yield error(
            name,
            f"{name} ends at its {end} level {level:.4g} in {count_of(len(lacks), 'stroke')} while "
            f"the motion goes on: up to {max(lacks):.2g} {name.rsplit('_', 1)[1]} are cut off",
            _CLIPPED_REMEDY,
        )


def _end_of_stroke(
    trial: RunSignals, name: str, stroke: Stroke
) -> tuple[float, float, bool] | None:
    """Return a channel's level at the end of a stroke, how much it lacks there, and if it is flat.

    It lacks what a line through the part of the stroke before foretells; None for a stroke that is
    short, that goes back on its second half, in which the channel does not follow, or that
    leaves the tendon slack.
    """
    x, y = (trial.channels[n][stroke.rows] for n in ("x_in_mm", name))
    share = (x - x[0]) / (x[-1] - x[0])
    before, last = (share > _BEFORE[0]) & (share < _BEFORE[1]), share > _LAST
    long = abs(x[-1] - x[0]) > _LONG * trial.sizes["x_in_mm"].span
    back_mm = np.maximum.accumulate(stroke.direction * x) - stroke.direction * x
    returns = bool(np.any(back_mm[share > _BEFORE[0]] > trial.visible("x_in_mm")))
    if not long or returns or min(before.sum(), last.sum()) < _FEWEST_ROWS:
        return None
    if not np.isfinite(y).all():
        return None
    slope, at_zero = np.polyfit(share[before], y[before], 1)
    if stroke.direction * slope < _FOLLOWS * trial.sizes[name].span:
        return None
    own = np.polyfit(share[last], y[last], 1)
    rows = np.flatnonzero(last) + stroke.rows.start
    if float(np.ptp(y[last])) == 0.0 or (stroke.direction < 0 and trial.is_slack(rows)):
        return None
    level = float(y[last].mean())
    lacks = stroke.direction * (at_zero + slope - level)
    flat = own[0] / slope < _FLAT and lacks > trial.visible(name) + 0.5 * (1.0 - _LAST) * abs(slope)
    straight = np.std(y[last] - np.polyval(own, share[last])) < _STRAIGHT * trial.visible(name)
    if flat and straight:
        late = share > _BEFORE[0]
        t, noise = trial.time_s[stroke.rows][late], _STRAIGHT * trial.visible(name)
        flat = not (
            _follows_speed(t, share[late], y[late], noise)
            or (name == "f_in_N" and _slips_last(trial, stroke.rows, share))
        )
    return level, float(lacks), bool(flat and straight)


def _follows_speed(t: Floats, share: Floats, y: Floats, noise: float) -> bool:
    """Return whether a line over place and speed fits the second half of a stroke to its end.

    The speed is that of a polynomial, since differences of samples have the encoder's noise.
    """
    speed = np.polynomial.Polynomial.fit(t, share, _DEGREE).deriv()(t)
    terms = np.column_stack((np.ones(t.size), share, speed))
    left = y - terms @ np.linalg.lstsq(terms, y, rcond=None)[0]
    return bool(np.sqrt(np.mean(left[share > _LAST] ** 2)) < noise)


def _slips_last(trial: RunSignals, rows: slice, share: Floats) -> bool:
    """Return whether the distal end moves at the end of a stroke alone.

    The tendon slips there as a whole, so that the tension at the drive rises no further.
    """
    for name in ("x_out_mm", "f_out_N"):
        if name in trial.channels and name != trial.prescribed:
            y = trial.channels[name][rows]
            ends = [float(np.nanmean(y[share > s][:_FEWEST_ROWS])) for s in _BEFORE]
            before, late = abs(ends[1] - ends[0]), abs(float(y[-_FEWEST_ROWS:].mean()) - ends[1])
            if late > max(trial.visible(name), _MOVES_LATE * before):
                return True
    return False


def _motion_continues(trial: RunSignals, name: str, rows: slice, sign: int) -> bool:
    """Return whether the motion continues beyond its position at the start of the plateau.

    Of the drive at rest a load that swings tells nothing: where it moves on, all channels follow.
    """
    coarse = 4.0 * trial.sizes[name].step / max(trial.sizes[name].span, 1e-300)
    further, returns = [], []
    for other in trial.references(name):
        moved = sign * (trial.channels[other][rows] - trial.channels[other][rows.start])
        span = trial.sizes[other].span
        needed = max(_TRAVEL, coarse) * span + trial.visible(other)
        further.append(float(np.nanmax(moved, initial=0.0)) > needed)
        returns.append(-float(np.nanmin(moved, initial=0.0)) >= 0.6 * span)
    if name == "x_in_mm":
        return bool(further) and all(further) and not all(returns)
    return any(f and not r for f, r in zip(further, returns, strict=True))
