"""The dynamic chain: lumps with mass, damping and bristles, followed in time.

Yang 2025, Eqs. (10) to (21), with half springs at both ends (second order in 1/n) and constants
that belong to the whole sheath, so that n does not change the physics. Steps are as long as the
error of a tension allows, and end where drive or load turn; samples in between are read off cubics.
With the steps of another run in place of its own control, what differs between two rigs is smooth.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, Boundary
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.lugre.ends import (
    StepEnds,
    end_stiffnesses,
    ends_after,
    input_error,
    write_samples,
)
from tsas_cli.physics.lugre.frames import (
    sliding_direction,
    store_tensions,
    write_along,
    write_slack_frames,
)
from tsas_cli.physics.lugre.input import next_reversal, step_at
from tsas_cli.physics.lugre.slack import end_of_slack, is_slack, without_tension, write_slack
from tsas_cli.physics.lugre.start import clear_state, lugre_laws, start_at_rest
from tsas_cli.physics.lugre.state import ROWS, Floats, LugreLaws
from tsas_cli.physics.lugre.step import accept_step, bdf2
from tsas_cli.physics.lugre.step_size import fit_to_reversal, step_factor, tolerances_of, try_step
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.phases import UNCONVERGED, Phases
from tsas_cli.physics.rig import Rig

SHORTEST_S = 1e-13
MOST_TRIES, MOST_PER_SAMPLE = 20_000, 40  # steps of a run, together
LEAVES_AT_MOST = 1e-5  # of a tension by Newton's method, since more looks right and is not
LEAVES_GIVEN = 1e-9  # where steps are given
OWN_STEPS = np.empty(0)  # as long as the error allows


class Progress(NamedTuple):
    """How a run went."""

    step_ends_s: Floats  # where steps ended
    tries: int  # the steps, and those that were too long
    iterations: int  # of Newton's method
    reached_s: float  # time to which the run was followed


@kernel
def lugre_chain(
    times: Floats,
    course: Floats,
    start: Floats,
    rig: Rig,
    boundary: Boundary,
    n: int,
    tolerance: float,
    step_ends_s: Floats,
    frames: Frames | None = None,
) -> tuple[Floats, Phases, Progress]:
    """Follow the motion of both ends from a state of rest.

    Parameters
    ----------
    times
        Of the samples, rising, shape (m,) [s].
    course
        The fields of `Moment` at each sample, shape (7, m); friction without its dependence on
        speed, which each lump has by itself.
    start
        Positions of the nodes and tensions of the segments behind them at the first sample, shape
        (2, n + 2) [mm, N].
    rig
        The rig; its friction and bend are taken from the course.
    boundary
        What is given at the ends.
    n
        Number of lumps, 2 to `MOST_NODES`.
    tolerance
        Error of a tension that a step may add, over the larger of the tensions at both ends.
    step_ends_s
        Where steps end, beside turns, rising [s], shape (p,): nothing limits their error then.
        Empty: as far as the error allows.
    frames
        Where to write down what is along the tendon, n elements with a lump in each.

    Returns
    -------
    columns
        x_in, x_out, f_in, f_out as `slip_chain` returns them, shape (4, m).
    phase
        +1 where all lumps slip in contraction, −1 in loosening, 0 where not, 2 slack, 3 from where
        the run was given up: columns keep their last values there. Shape (m,).
    progress
        How it went.
    """
    m = times.size
    columns, phase = np.empty((4, m)), np.full(m, UNCONVERGED, dtype=np.int8)
    s, law = np.empty(ROWS * PITCH), lugre_laws(rig, n)
    clear_state(s, rig, n)
    ends = earlier = start_at_rest(s, start, times, course, 0, times[0], boundary, law)
    write_samples(columns, 0, 1, times, course, times[0] - 1.0, 1.0, ends, ends, boundary, law)
    phase[0] = 0
    k, t, turn = 0, times[0], next_reversal(times, course, 0, boundary)
    first = h = 0.1 * (times[min(1, m - 1)] - t)
    h1 = h2 = math.inf  # the two steps before; none yet
    least = law.load_stiffness_N_per_mm  # tension for what is given at an end
    answers = least, least
    steps = tries = iterations = 0
    ends_s = np.empty(MOST_TRIES + MOST_PER_SAMPLE * m)  # as many as may be tried
    controlled, stop = step_ends_s.size == 0, 0
    taken, along = 0, np.empty((4, n + 1))
    if frames is not None:  # here and below compiled away where none are asked for
        store_tensions(s, along, law)
        store_tensions(s, along, law)
        taken = write_along(frames, taken, times, 0, t, 1.0, s, along, law)
    while k < m - 1 and h > SHORTEST_S and tries < ends_s.size:
        tries += 1
        most = tolerances_of(ends, law, tolerance, LEAVES_AT_MOST)
        if not controlled:
            most = tolerances_of(ends, law, math.inf, LEAVES_GIVEN)
            stop = sample_after(step_ends_s, stop, t + SHORTEST_S)
            h = min(h, step_ends_s[stop] - t) if stop < step_ends_s.size else h
        h, lands = fit_to_reversal(h, times[turn] - t)
        t1 = times[turn] if lands else t + h
        k1 = sample_before(times, k, t1)
        formula = bdf2(h, h1, h2)
        drives = ends.drive, earlier.drive
        step = step_at(times, course, k1, t1, formula, drives, n, boundary)
        off, done = math.inf, 0
        if input_error(times, course, k, k1, t, h, ends, step, answers, boundary) <= most.error_N:
            off, done = try_step(s, step, formula, boundary, law, most)
        iterations += done
        change = step_factor(off, most, formula)
        if not off < most.error_N:
            h *= change
            continue
        ends_s[steps] = t1
        steps += 1
        earlier, ends = ends, ends_after(s, step, law)
        since = k + 1
        k = k1 + 1 if times[k1 + 1] <= t1 else k1
        write_samples(columns, since, k + 1, times, course, t, h, earlier, ends, boundary, law)
        now = phase_of(s, law)
        phase[since : k + 1] = now
        if frames is not None:
            store_tensions(s, along, law)
            taken = write_along(frames, taken, times, k, t, h, s, along, law)
        accept_step(s, step, law)
        answers = end_stiffnesses(earlier, ends, least)
        first = h if h1 == math.inf else first
        t, h, h1, h2 = t1, h * change if controlled else math.inf, h, h1
        if has_gone_slack(s, times, course, k, t, ends, boundary, law):
            since = k + 1
            k, t = end_of_slack(s, times, course, k, t, boundary, law)
            write_slack(columns, phase, s, times, course, (since, k + 1), boundary, law)
            lands = True
            if k < m - 1:
                start = without_tension(s, times, course, k, t, boundary, law)
                ends = start_at_rest(s, start, times, course, k, t, boundary, law)
            if frames is not None:
                taken = write_slack_frames(frames, taken, k)
                store_tensions(s, along, law)
        if lands and k < m - 1:
            turn = next_reversal(times, course, k, boundary)
            h, h1, h2 = first if controlled else math.inf, math.inf, math.inf
    for i in range(k + 1, m):
        columns[:, i] = columns[:, k]
    return columns, phase, Progress(ends_s[:steps].copy(), tries, iterations, t)


@kernel
def sample_after(times: Floats, k: int, t: float) -> int:
    """Return the first of some times from k on that is after a time, or their number."""
    while k < times.size and times[k] <= t:
        k += 1
    return k


@kernel
def sample_before(times: Floats, k: int, t: float) -> int:
    """Return the last sample from k on that is before a time."""
    while times[k + 1] < t:
        k += 1
    return k


@kernel
def has_gone_slack(
    s: Floats,
    times: Floats,
    course: Floats,
    k: int,
    t: float,
    ends: StepEnds,
    boundary: Boundary,
    law: LugreLaws,
) -> bool:
    """Say whether the tendon has gone slack; with a given force at the load it cannot."""
    if boundary.load == FORCE or ends.f_in >= 0.0:
        return False
    return is_slack(s, times, course, min(k, times.size - 2), t, boundary, law)


@kernel
def phase_of(s: Floats, law: LugreLaws) -> int:
    """Return +1 or −1 where all lumps slip alike, 0 otherwise."""
    pulled = released = 0
    for i in range(1, law.n + 1):
        way = sliding_direction(s, i, law)
        pulled += way > 0
        released += way < 0
    return int(pulled == law.n) - int(released == law.n)
