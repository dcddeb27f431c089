"""The checks of signs, and of sensors that are exchanged."""

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.trial import RunSignals

_CLEAR_SIGN = 0.8
_CLEAR_EXCESS = 0.03  # of the span
_OF_THE_LEAD = 0.1  # by which a displacement may differ from a tension that it sets


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
    excess = _excess_while_pulling(trial, "f_in_N", "f_out_N")
    clear = max(_CLEAR_EXCESS * trial.sizes["f_in_N"].span, _visible(trial, "f_in_N", "f_out_N"))
    if excess < -clear:
        yield error(
            "f_in_N",
            f"at the same f_out_N, f_in_N is {-excess:.3g} N lower in contraction than in "
            "loosening; friction makes it higher",
            "exchange the columns of f_in_N and f_out_N at ingest, or check the sign of x_in_mm, "
            "and offset_s where two files were joined",
        )
    if not trial.on_spring or "x_out_mm" not in trial.mechanical:
        return
    lead = -_excess_while_pulling(trial, "x_in_mm", "x_out_mm")
    apart = [_excess_while_pulling(trial, "x_in_mm", tension) for tension in ("f_in_N", "f_out_N")]
    if min(map(abs, apart)) < _OF_THE_LEAD * lead and lead > _visible(trial, "x_in_mm", "x_out_mm"):
        yield error(
            "x_in_mm",
            f"at the same x_out_mm, x_in_mm is {lead:.3g} mm lower in contraction than in "
            "loosening, and a tension follows x_in_mm as it follows a spring at the load",
            "exchange the columns of x_in_mm and x_out_mm at ingest",
        )


def _visible(trial: RunSignals, one: str, other: str) -> float:
    """Return the mean of the smallest changes that show in two channels."""
    return 0.5 * (trial.visible(one) + trial.visible(other))


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
