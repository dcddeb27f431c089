"""The checks of channels against the motion of the drive."""

import math

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, warning
from tsas_cli.recordings.quality.trial import RunSignals, Stroke
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import count_of

_BESIDE_S, _OF_A_STROKE = 0.4, 0.06  # stretch on either side, at most
_APART = 0.3  # of it: the time of the reversal itself
_FEWEST_ROWS, _FEWEST_REVERSALS, _FEWEST_JUMPS = 6, 4, 3
_SHOWING = 0.5  # share of the reversals that have to show it: short strokes look like a jump too
_RESTS = 1.5  # noise levels of a change while the load rests
_PART = 0.2  # of a jump, that it may change by then
_MOVED = 0.25  # share of a stroke of the load, after which it moves
_WHOLE = 0.75  # of what separates the branches: a jump that is no damper's
_VISIBLE, _CRITICAL = 4.0, 6.0  # noise levels, and standard errors of the mean,
_CHANCE = 0.005  # or as many as few jumps by chance have with this probability, on either side


def interference(trial: RunSignals) -> Findings:
    """A channel at the load jumps whenever the drive reverses.

    In the dead band after a reversal of the drive the load rests, so nothing there can jump with
    it. What does is an interference that follows the direction of the motor: its current in the
    cable of a sensor, or a correction by the sign of the speed. Beside it f_in may jump too; that
    looks like friction of the drive. What is late jumps too, against the direction, and so does the
    force of a load with a mass, where it stops braking. A damped load stops as well: its force
    jumps by half of what separates it between pulling and loosening, an interference by all of it.
    """
    from scipy.special import stdtrit

    if len(trial.strokes) <= _FEWEST_REVERSALS:
        yield NotChecked("the drive has too few reversals")
        return
    for name in [n for n in ("x_out_mm", "f_out_N") if n in trial.noisy]:
        jumps = _jumps(trial, trial.noisy[name], trial.sizes[name].noise)
        if jumps.size < max(_FEWEST_JUMPS, _SHOWING * (len(trial.strokes) - 1)):
            continue
        critical = max(_CRITICAL, float(stdtrit(jumps.size - 1, 1.0 - _CHANCE)))
        mean, error = float(jumps.mean()), float(jumps.std(ddof=1)) / math.sqrt(jumps.size)
        if abs(mean) > max(_VISIBLE * trial.sizes[name].noise, critical * error):
            unit, causes = name.rsplit("_", 1)[1], []
            if name == "f_out_N" and (mean < 0.0 or not mean > _WHOLE * _between_branches(trial)):
                causes = ["mass of the load" if mean < 0.0 else "damping of the load"]
            causes += ["a delay"] if mean < 0.0 else []
            others = "".join(f"{cause}, " for cause in causes) + ("or " if causes else "")
            yield Finding(
                "warning" if causes else "error",
                name,
                f"{name} jumps by {abs(mean):.2g} {unit} when the drive reverses, where the load "
                f"still rests: {others}interference that follows the motor's direction",
                "shield the sensor's cable from the motor's, and look for corrections by the sign "
                "of the speed",
            )


def _between_branches(trial: RunSignals) -> float:
    """Return by how much f_out is higher in contraction than in loosening at the same x_out [N].

    While the load moves; infinite where x_out was not recorded, or moves too little.
    """
    x_out, f_out = trial.channels.get("x_out_mm"), trial.channels["f_out_N"]
    if x_out is None:
        return math.inf
    parts = []
    for stroke in trial.strokes:
        x, f = x_out[stroke.rows], f_out[stroke.rows]
        moves = np.abs(x - x[0]) > max(_MOVED * float(np.ptp(x)), trial.visible("x_out_mm"))
        rows = moves & np.isfinite(f)
        parts.append(np.column_stack([x[rows], f[rows], np.full(rows.sum(), stroke.direction)]))
    x, f, way = np.concatenate(parts).T
    if not ((way > 0.0).any() and (way < 0.0).any()):
        return math.inf
    columns = np.column_stack([0.5 * way, np.vander(x - x.mean(), 4)])
    return float(np.linalg.lstsq(columns, f, rcond=None)[0][0])


def _jumps(trial: RunSignals, values: Floats, noise: float) -> Floats:
    """Return the jump of a channel at each reversal after which it rests, with the drive.

    Until then it follows the drive, however that brakes.
    """
    found = []
    x = trial.channels["x_in_mm"]
    known = np.isfinite(x) & np.isfinite(values)
    for old, new in zip(trial.strokes, trial.strokes[1:], strict=False):
        if old.stop != new.start or old.direction == new.direction or not known[old.stop]:
            continue
        lasts = min(trial.time_s[s.stop] - trial.time_s[s.start] for s in (old, new))
        beside_s = min(_BESIDE_S, _OF_A_STROKE * lasts)
        t = (trial.time_s - trial.time_s[old.stop]) / beside_s
        after = known & (t > _APART) & (t < 1.0 + _APART)
        before = known & (t < -_APART) & (t > -1.0 - _APART)
        if min(after.sum(), before.sum()) < _FEWEST_ROWS:
            continue
        slope, level = _polynomial(t[after], values[after], 1)
        jump = level - _polynomial(x[before] - x[old.stop], values[before], 2)[-1]
        if abs(slope) < max(_RESTS * noise, _PART * abs(jump)):
            found.append(new.direction * jump)
    return np.array(found)


def _polynomial(t: Floats, values: Floats, degree: int) -> Floats:
    return np.asarray(np.linalg.lstsq(np.vander(t, degree + 1), values, rcond=None)[0])


_ENOUGH_REVERSALS = 3


def few_reversals(trial: RunSignals) -> Findings:
    """The drive has too few reversals.

    Two full cycles have three reversals. With fewer, a run shows each phase at most once, so that
    its repeatability is unknown.
    """
    reversals = max(len(trial.strokes) - 1, 0)
    if reversals >= _ENOUGH_REVERSALS:
        return
    moves = f"has {count_of(reversals, 'reversal')}"
    yield warning(
        "x_in_mm",
        f"x_in_mm {moves if trial.strokes else 'does not move visibly'}; two full cycles have "
        f"{_ENOUGH_REVERSALS} reversals",
        "record at least two full cycles of contraction and loosening",
    )


_ENOUGH_MOVING = 0.2
_FEWEST_MOVING_ROWS = 10
_INDICATORS = {
    "spring": ("x_out_mm", "f_out_N"),
    "force": ("x_out_mm",),
    "displacement": ("f_out_N",),
}


def no_steady_motion(trial: RunSignals) -> Findings:
    """The tendon never slips through to the load in one of the two directions.

    After a reversal the drive first crosses a dead band, in which the distal end rests. The
    stiffness of contraction and of loosening is identifiable only from strokes that continue well
    beyond it: the distal end has to move in at least a fifth of one stroke.
    """
    indicators = [n for n in _INDICATORS[trial.recording.run.load] if n in trial.channels]
    if not indicators:
        yield NotChecked("no channel shows when the distal end moves")
        return
    for phase, direction in (("contraction", 1), ("loosening", -1)):
        strokes = [s for s in trial.strokes if s.direction == direction]
        share = max((_moving(trial, n, s) for n in indicators for s in strokes), default=1.0)
        if share < _ENOUGH_MOVING:
            yield warning(
                indicators[0],
                f"no steady {phase}: by {' and '.join(indicators)}, the distal end moves in at "
                f"most {100 * share:.2g} % of a stroke of x_in_mm",
                "record longer strokes, so that the load moves well beyond the dead band",
            )


def _moving(trial: RunSignals, name: str, stroke: Stroke) -> float:
    """Return the share of a stroke's travel that lies after the distal end has begun to move."""
    values, x = trial.channels[name][stroke.rows], trial.channels["x_in_mm"][stroke.rows]
    valid = np.isfinite(values) & np.isfinite(x)
    if not valid.any():
        return 0.0
    values, x = values[valid], x[valid]
    limit = max(trial.visible(name), 0.02 * trial.sizes[name].span)
    away = np.abs(values - values[0]) > limit
    if not away[-1]:
        return 0.0
    begin = int(np.flatnonzero(~away)[-1])
    if away.size - begin < _FEWEST_MOVING_ROWS:
        return 0.0
    return float(abs((x[-1] - x[begin]) / (x[-1] - x[0])))
