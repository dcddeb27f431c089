"""The checks of channels against the motion of the drive."""

import math

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.trial import RunSignals, Stroke
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import count_of

_CLEAR_SIGN = 0.8


def sign(trial: RunSignals) -> Findings:
    """A channel has the wrong sign.

    Pulling at the drive is positive, the distal end follows it, and a tendon cannot push: over each
    stroke of the drive the distal displacement and, with a spring as load, both tensions rise with
    `x_in_mm`. If all other channels move opposite to the drive, the sign of the drive is wrong.
    """
    tensions = [name for name in trial.mechanical if name.startswith("f_")]
    pushing = [n for n in tensions if np.nanpercentile(trial.channels[n], 98.0) < -trial.visible(n)]
    followers = ["x_out_mm"] if "x_out_mm" in trial.mechanical else []
    followers += tensions if trial.on_spring else []  # with a driven load, tensions need not follow
    scores = {name: trial.follows(name) or 0.0 for name in followers}
    against = [name for name, score in scores.items() if score < -_CLEAR_SIGN]
    together = [name for name, score in scores.items() if score > _CLEAR_SIGN]
    if against and not together and not pushing and against != ["x_out_mm"]:
        yield _wrong_sign("x_in_mm", f"moves opposite to {', '.join(against)} in each stroke")
        return
    for name in against:
        yield _wrong_sign(name, "moves opposite to x_in_mm in each stroke")
    for name in [n for n in pushing if n not in against]:
        share = 100.0 * float(np.mean(trial.channels[name] < 0.0))
        yield _wrong_sign(
            name, f"is negative in {share:.3g} % of the samples; a tendon cannot push"
        )
    if not against and not together and not pushing:
        yield NotChecked("no channel that follows x_in_mm moves visibly")


def _wrong_sign(column: str, what: str) -> Finding:
    return error(
        column,
        f"{column} {what}",
        f"invert the sign of {column} at ingest, after checking how the sensor is mounted",
    )


def negative_tension(trial: RunSignals) -> Findings:
    """A tension is negative for part of the run.

    A tendon cannot push. Most often the sensor was zeroed under preload, so that the column holds
    the change of the tension; or it reads the difference of two tendons; or its zero has drifted.
    With a second tendon the load's force, and what the drive feels, may push.
    """
    if trial.rig.antagonist_preload_N is not None:
        yield NotChecked("the rig has a second tendon, so that a force may be negative")
        return
    for name in trial.mechanical:
        if not name.startswith("f_"):
            continue
        values = trial.channels[name]
        limit = trial.reading_of_none(name)
        low, high = np.nanpercentile(values, (0.5, 98.0))
        if low < -limit and high >= -trial.visible(name):  # else the sign check reports it
            share = 100.0 * float(np.mean(values < 0.0))
            yield warning(
                name,
                f"{name} is negative in {share:.3g} % of the samples, down to {low:.4g} N",
                "add the preload at ingest if the sensor was zeroed under it, or correct its "
                "offset; of the difference of two tendons, which may be negative, state "
                "antagonist_preload_N under [rig]",
                float(trial.time_s[np.argmax(values < -limit)]),
            )


_CLEAR_EXCESS = 0.03  # of the span
_OF_THE_LEAD = 0.1  # by which a displacement may differ from a tension that it sets


def exchanged(trial: RunSignals) -> Findings:
    """The two tension sensors are exchanged, or the two displacement sensors.

    With friction, at the same distal tension, the proximal tension is higher during contraction
    than during loosening. If it is lower, the proximal and the distal column are exchanged (or
    `x_in_mm` has the wrong sign, if no other channel shows its sign). So is the displacement at the
    drive at the same displacement of the load. If it is lower, a sensor may also be late; that a
    tension is the same in both directions at the same `x_in_mm`, as a spring at the load has it,
    shows that the two are exchanged.
    """
    against = [n for n in ("f_in_N", "f_out_N") if (trial.follows(n) or 0.0) < 0.0]
    if against and trial.on_spring:
        yield NotChecked(f"the sign of {against[0]} against x_in_mm is in doubt")
        return
    if len({stroke.direction for stroke in trial.strokes}) < 2:
        yield NotChecked("the drive does not move in both directions")
        return

    def visible(*names: str) -> float:
        return float(np.mean([trial.visible(name) for name in names]))

    excess = _excess_while_pulling(trial, "f_in_N", "f_out_N")
    if excess < -max(_CLEAR_EXCESS * trial.sizes["f_in_N"].span, visible("f_in_N", "f_out_N")):
        yield error(
            "f_in_N",
            f"at the same f_out_N, f_in_N is {-excess:.3g} N lower in contraction than in "
            "loosening; friction makes it higher",
            "exchange the columns of f_in_N and f_out_N at ingest, or check the sign of x_in_mm",
        )
    if not trial.on_spring or "x_out_mm" not in trial.mechanical:
        return
    lead = -_excess_while_pulling(trial, "x_in_mm", "x_out_mm")
    apart = [_excess_while_pulling(trial, "x_in_mm", tension) for tension in ("f_in_N", "f_out_N")]
    if min(map(abs, apart)) < _OF_THE_LEAD * lead and lead > visible("x_in_mm", "x_out_mm"):
        yield error(
            "x_in_mm",
            f"at the same x_out_mm, x_in_mm is {lead:.3g} mm lower in contraction than in "
            "loosening, and a tension follows x_in_mm as it follows a spring at the load",
            "exchange the columns of x_in_mm and x_out_mm at ingest",
        )


def _excess_while_pulling(trial: RunSignals, proximal: str, distal: str) -> float:
    """Return d of proximal = a + b distal + d/2 · direction.

    It is fitted over the travel of the drive: each row counts by what the drive moves there, since
    in a rest friction may have either sign. A wrong gain or offset of a sensor enters a and b. If
    the load's own tension reverses with the direction, b and d are indistinguishable; a negative b
    is implausible and left out.
    """
    y, x, direction = trial.channels[proximal], trial.channels[distal], trial.direction
    travel = direction * np.gradient(trial.channels["x_in_mm"])
    rows = (travel > 0.0) & np.isfinite(y) & np.isfinite(x)
    weight = np.sqrt(travel[rows])
    terms = np.column_stack([direction[rows] / 2.0, np.ones(weight.size), x[rows]])
    terms *= weight[:, None]
    measured = weight * y[rows]
    fit = np.linalg.lstsq(terms, measured, rcond=None)[0]
    if fit[2] < 0.0:
        fit = np.linalg.lstsq(terms[:, :2], measured, rcond=None)[0]
    return float(fit[0])


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
