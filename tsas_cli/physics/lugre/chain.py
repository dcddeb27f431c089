"""The dynamic chain: lumps with mass, damping and bristles, integrated in time.

Yang 2025, Eqs. (10) to (21), with half springs at both ends (second order in 1/n) and constants of
the whole sheath, so that n does not change the physics. Steps are as long as the error of a tension
allows, and end at reversals of drive or load; samples in between are interpolated by cubics. With
the steps of another run in place of step control, outputs are smooth functions of the rig.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, Boundary
from tsas_cli.physics.course import TIME, Output
from tsas_cli.physics.lugre.ends import (
    F_IN,
    F_OUT,
    X_IN,
    X_OUT,
    Samples,
    Span,
    StepEnds,
    end_stiffnesses,
    ends_after,
    input_error,
    write_samples,
)
from tsas_cli.physics.lugre.input import next_reversal, step_at
from tsas_cli.physics.lugre.slack import (
    end_of_slack,
    is_slack,
    load_position,
    slack_state,
    write_slack,
)
from tsas_cli.physics.lugre.start import clear_state, lugre_laws, start_at_rest
from tsas_cli.physics.lugre.state import DEFLECTION_NEW, LIMIT, ROWS, LugreLaws
from tsas_cli.physics.lugre.step import (
    accept_step,
    bdf2,
    fit_to_reversal,
    step_factor,
    tolerances_of,
    try_step,
)
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.phases import SLIDING_SHARE, UNCONVERGED
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

SHORTEST_S = 1e-13
MOST_TRIES, MOST_PER_SAMPLE = 20_000, 40  # their sum limits the steps of a run
MOST_RESIDUAL = 1e-5  # of Newton's method, over a tension: a larger one gives wrong solutions
RESIDUAL_GIVEN_STEPS = 1e-9  # the same where steps are given
OWN_STEPS = np.empty(0)  # for steps by error control


class StepControl(NamedTuple):
    """Error control of steps, or given steps.

    `tolerance` is the error of a tension that a step may add, over the larger of the tensions at
    both ends. `ends_s` are the given ends of steps, besides reversals, increasing [s], shape (p,):
    their error is not limited then. Empty: steps by error control.
    """

    tolerance: float
    ends_s: Floats


class Progress(NamedTuple):
    """Statistics of a simulated run."""

    step_ends_s: Floats  # of the accepted steps
    tries: int  # accepted and rejected steps
    iterations: int  # of Newton's method
    reached_s: float  # end of the last accepted step


@kernel
def lugre_chain(
    course: Floats,
    start: Floats,
    rig: Rig,
    boundary: Boundary,
    n: int,
    control: StepControl,
) -> tuple[Output, Progress]:
    """Return the output for the motion of both ends from a state of rest.

    Parameters
    ----------
    course
        Inputs of the tendon, with the rows of `course`, shape (11, m), and increasing times;
        friction without its dependence on speed, which each lump has by itself.
    start
        Positions of the nodes and tensions of the segments behind them at the first sample, shape
        (2, n + 2) [mm, N].
    rig
        The rig; its friction and bend are those of the course.
    boundary
        The given quantity at each end.
    n
        Number of lumps, 2 to `MOST_NODES`.
    control
        Error control of steps, or given steps.

    Returns
    -------
    output
        As that of the slip chain; where a run is aborted, the rest has phase 3 and the last values.
    progress
        Statistics of the run.
    """
    m = course.shape[1]
    columns, phase = np.empty((4, m)), np.full(m, UNCONVERGED, dtype=np.int8)
    s, laws = np.empty(ROWS * PITCH), lugre_laws(rig, n, boundary)
    clear_state(s, rig, n)
    ends = earlier = start_at_rest(s, start, course, 0, course[TIME, 0], laws)
    write_samples(
        columns, Samples(0, 1), course, Span(course[TIME, 0] - 1.0, 1.0), ends, ends, laws
    )
    phase[0] = 0
    k, t, reversal = 0, course[TIME, 0], next_reversal(course, 0, laws)
    first = h = 0.1 * (course[TIME, min(1, m - 1)] - t)
    h1 = h2 = math.inf  # the two steps before; none yet
    least = laws.load.stiffness_N_per_mm  # change of tension over that of the given quantity
    stiffness = least, least
    steps = tries = iterations = 0
    ends_s = np.empty(MOST_TRIES + MOST_PER_SAMPLE * m)  # as many as may be tried
    controlled, stop = control.ends_s.size == 0, 0
    while k < m - 1 and h > SHORTEST_S and tries < ends_s.size:
        tries += 1
        most = tolerances_of(ends, laws, control.tolerance, MOST_RESIDUAL)
        if not controlled:
            most = tolerances_of(ends, laws, math.inf, RESIDUAL_GIVEN_STEPS)
            stop = sample_after(control.ends_s, stop, t + SHORTEST_S)
            h = min(h, control.ends_s[stop] - t) if stop < control.ends_s.size else h
        h, lands = fit_to_reversal(h, course[TIME, reversal] - t)
        t1, span = course[TIME, reversal] if lands else t + h, Span(t, h)
        k1 = sample_before(course, k, t1)
        formula = bdf2(h, h1, h2)
        drives = ends.drive.given.value, earlier.drive.given.value
        step = step_at(course, k1, t1, formula, drives, laws)
        error_N, used = math.inf, 0
        input_N = input_error(course, Samples(k + 1, k1), span, ends, step, stiffness, laws)
        if input_N <= most.error_N:
            error_N, used = try_step(s, step, formula, laws, most)
        iterations += used
        change = step_factor(error_N, most, formula)
        if not error_N < most.error_N:
            h *= change
            continue
        ends_s[steps] = t1
        steps += 1
        earlier, ends = ends, ends_after(s, step, laws)
        since = k + 1
        k = k1 + 1 if course[TIME, k1 + 1] <= t1 else k1
        write_samples(columns, Samples(since, k + 1), course, span, earlier, ends, laws)
        now = phase_of(s, laws)
        phase[since : k + 1] = now
        accept_step(s, step, laws)
        stiffness = end_stiffnesses(earlier, ends, least)
        first = h if h1 == math.inf else first
        t, h, h1, h2 = t1, h * change if controlled else math.inf, h, h1
        if has_gone_slack(s, course, k, t, ends, laws):
            since = k + 1
            k, t = end_of_slack(s, course, k, t, laws)
            write_slack(columns, phase, Samples(since, k + 1), s, course, laws)
            lands = True
            if k < m - 1:
                start = slack_state(s, load_position(course, k, t, laws), laws)
                ends = start_at_rest(s, start, course, k, t, laws)
        if lands and k < m - 1:
            reversal = next_reversal(course, k, laws)
            h, h1, h2 = first if controlled else math.inf, math.inf, math.inf
    for i in range(k + 1, m):
        columns[:, i] = columns[:, k]
    output = Output(columns[X_IN], columns[X_OUT], columns[F_IN], columns[F_OUT], phase)
    return output, Progress(ends_s[:steps].copy(), tries, iterations, t)


@kernel
def sample_after(times: Floats, k: int, t: float) -> int:
    """Return the first index from k on of a later time, or the number of times."""
    while k < times.size and times[k] <= t:
        k += 1
    return k


@kernel
def sample_before(course: Floats, k: int, t: float) -> int:
    """Return the last sample from k on that is before a time."""
    while course[TIME, k + 1] < t:
        k += 1
    return k


@kernel
def has_gone_slack(
    s: Floats, course: Floats, k: int, t: float, ends: StepEnds, laws: LugreLaws
) -> bool:
    """Return whether the tendon has gone slack; with a given force at the load it cannot."""
    if laws.load.given == FORCE or ends.drive.tension >= 0.0:
        return False
    return is_slack(s, course, min(k, course.shape[1] - 2), t, laws)


@kernel
def phase_of(s: Floats, laws: LugreLaws) -> int:
    """Return +1 or −1 where all lumps slip in that direction, else 0."""
    pulled = released = 0
    for i in range(1, laws.n + 1):
        direction = sliding_direction(s, i, laws)
        pulled += direction > 0
        released += direction < 0
    return int(pulled == laws.n) - int(released == laws.n)


@kernel
def sliding_direction(s: Floats, i: int, laws: LugreLaws) -> int:
    """Return +1 or −1 where a lump's bristles are at their limit, 0 where they are not."""
    steady = s[LIMIT + i] / laws.lump.bristle.stiffness + laws.lump.bristle.travel
    return int(s[DEFLECTION_NEW + i] > SLIDING_SHARE * steady) - int(
        s[DEFLECTION_NEW + i] < -SLIDING_SHARE * steady
    )
