"""The dynamic chain: lumps with mass, damping and bristles, followed in time.

Yang 2025, Eqs. (10) to (21), with half springs at both ends (second order in 1/n) and constants
that belong to the whole sheath, so that n does not change the physics. Steps are as long as the
error of a tension allows, and end where drive or load turn; samples in between are read off cubics.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.effects.load_friction import guide_friction
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.bristles import Bristle, bristle_damping, tendon_mass
from tsas_cli.physics.chain_state import DISPLACEMENT, FORCE, Boundary
from tsas_cli.physics.lugre_balance import balance
from tsas_cli.physics.lugre_input import (
    DRIVE,
    LOAD,
    departs,
    hermite,
    next_turn,
    step_at,
)
from tsas_cli.physics.lugre_slack import is_slack, pulled_again, without_tension, write_slack
from tsas_cli.physics.lugre_state import (
    DAMPING,
    FRICTION,
    LIMIT,
    PITCH,
    REST,
    ROWS,
    STIFFNESS,
    T_BY_W,
    T_PAST,
    V_PAST,
    Y_NEW,
    Y_PAST,
    Z_NEW,
    Z_PAST,
    Floats,
    Law,
    Phases,
    Step,
    T,
    V,
    W,
    Y,
    Z,
)
from tsas_cli.physics.lugre_step import error, formula_length, keep, look_back, newton
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip_chain import segment_compliances

SHORTEST_S = 1e-10
MOST_TRIES, MOST_PER_SAMPLE = 20_000, 40  # steps of a run, together
LEAVES = 0.1  # of the error of a step: what Newton's method may leave
LONGER, SHORTER, CAREFUL = 2.0, 0.25, 0.9  # how the step may change, and how much of it is taken
SLIDES = 0.99  # share of its limit from which a lump is said to slip


class Progress(NamedTuple):
    """How a run went."""

    steps: int
    tries: int  # those included that were too long
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
    longest_s: float,
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
        Number of lumps, 2 to `MOST_LUMPS`.
    tolerance
        Error of a tension that a step may add, over the larger of the tensions at both ends.
    longest_s
        Longest step.

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
    columns, phase = np.empty((4, m)), np.full(m, 3, dtype=np.int8)
    s, law = np.empty(ROWS * PITCH), law_of(rig, n)
    lay_out(s, rig, n)
    ends = set_off(s, start, times, course, 0, times[0], boundary, law)
    write_sample(columns, 0, course, 1.0, 1.0, ends, ends, boundary, law)
    phase[0] = 0
    k, t, turn = 0, times[0], next_turn(times, course, 0, boundary)
    first = h = 0.1 * (times[min(1, m - 1)] - t)
    h1 = h2 = math.inf  # the two steps before; none yet
    felt = law.load_stiffness_N_per_mm  # tension for what is given at the drive
    steps = tries = iterations = 0
    while k < m - 1 and h > SHORTEST_S and tries < MOST_TRIES + MOST_PER_SAMPLE * m:
        tries += 1
        scale = tolerance * max(abs(ends.f_in), abs(ends.f_out), 0.1 * law.preload_N)
        h, lands = fitted(min(h, longest_s), times[turn] - t)
        t1 = times[turn] if lands else t + h
        k1 = sample_before(times, k, t1)
        step = step_at(times, course, k1, t1, formula_length(h, h1), n, boundary)
        off, done = math.inf, 0
        if departs(times, course, DRIVE, t, k, t1, k1) * felt <= scale:
            look_back(s, law, step.gh, h, h1, h2)
            done, solved = newton(s, step, boundary, law, LEAVES * scale)
            off = error(s, law, step.gh, h, h1, h2) if solved else math.inf
        iterations += done
        change = CAREFUL * (scale / (off + 1e-300)) ** (1.0 / 3.0 if h2 < math.inf else 0.5)
        if not off <= scale:
            h *= max(SHORTER, change)
            continue
        steps += 1
        before, ends = ends, ends_after(s, step, law)
        sliding = phase_of(s, law)
        while k < m - 1 and times[k + 1] <= t1:
            k += 1
            write_sample(columns, k, course, (times[k] - t) / h, h, before, ends, boundary, law)
            phase[k] = sliding
        keep(s, step, law)
        felt = max(felt_by_drive(before, ends), law.load_stiffness_N_per_mm)
        first = h if h1 == math.inf else first
        t, h, h1, h2 = t1, h * min(LONGER, change), h, h1
        if hangs(s, times, course, k, t, ends, boundary, law):
            since = k + 1
            k, t = pulled_again(s, times, course, k, t, boundary, law)
            write_slack(columns, phase, s, times, course, (since, k + 1), boundary, law)
            start = without_tension(s, times, course, k, t, boundary, law)
            ends = set_off(s, start, times, course, k, t, boundary, law)
            lands = True
        if lands and k < m - 1:
            turn = next_turn(times, course, k, boundary)
            h, h1, h2 = first, math.inf, math.inf
    for i in range(k + 1, m):
        columns[:, i] = columns[:, k]
    return columns, phase, Progress(steps, tries, iterations, t)


@kernel
def fitted(h: float, left: float) -> tuple[float, bool]:
    """Return a step that does not pass what is left to the next turn, and whether it lands there.

    Before a short rest it takes half of both.
    """
    if h > (1.0 - 1e-9) * left:
        return left, True
    return (0.5 * left if 2.0 * h > left else h), False


@kernel
def sample_before(times: Floats, k: int, t: float) -> int:
    """Return the last sample from k on that is before a time."""
    while times[k + 1] < t:
        k += 1
    return k


class Ends(NamedTuple):
    """Both ends of the tendon at the end of a step, with rates for what is read in between."""

    drive: float  # what is given [mm or N]
    x_in: float  # relative to the drive [mm]
    w_in: float
    x_out: float  # relative to the drive [mm]
    w_out: float
    f_in: float  # tension [N]
    f_in_rate: float
    f_out: float
    f_out_rate: float
    guide: float  # friction of the load's guide [N]


@kernel
def ends_after(s: Floats, step: Step, law: Law) -> Ends:
    """Return what the ends are after a step; positions go to Y_NEW."""
    n, last = law.n, law.n + 1
    for i in range(n + 2):
        s[Y_NEW + i] = s[Y_PAST + i] + step.gh * s[W + i]
    return Ends(
        step.drive,
        s[Y_NEW],
        s[W],
        s[Y_NEW + last],
        s[W + last],
        s[T],
        s[STIFFNESS] * (s[W] - s[W + 1]),
        s[T + n],
        s[STIFFNESS + n] * (s[W + n] - s[W + last]),
        s[FRICTION + last],
    )


@kernel
def felt_by_drive(before: Ends, after: Ends) -> float:
    """Return how much the tension at the drive changed for what is given there."""
    moved = abs(after.drive - before.drive)
    return abs(after.f_in - before.f_in) / moved if moved > 0.0 else 0.0


@kernel
def hangs(
    s: Floats,
    times: Floats,
    course: Floats,
    k: int,
    t: float,
    ends: Ends,
    boundary: Boundary,
    law: Law,
) -> bool:
    """Say whether the tendon has gone slack; with a given force at the load it cannot."""
    if boundary.load == FORCE or ends.f_in >= 0.0:
        return False
    return is_slack(s, times, course, min(k, times.size - 2), t, boundary, law)


@kernel
def write_sample(
    columns: Floats,
    k: int,
    course: Floats,
    part: float,
    h: float,
    a: Ends,
    b: Ends,
    boundary: Boundary,
    law: Law,
) -> None:
    """Write what the ends are at a sample, at a part of the step from a to b."""
    x_in = course[DRIVE, k]
    f_in = hermite(part, h, a.f_in, a.f_in_rate, b.f_in, b.f_in_rate)
    x_out = x_in + hermite(part, h, a.x_out, a.w_out, b.x_out, b.w_out)
    if boundary.drive == FORCE:
        x_out -= x_in
        x_in, f_in = hermite(part, h, a.x_in, a.w_in, b.x_in, b.w_in), course[DRIVE, k]
    if boundary.load == FORCE:
        f_out = course[LOAD, k]
    else:
        f_out = hermite(part, h, a.f_out, a.f_out_rate, b.f_out, b.f_out_rate)
        f_out -= sensor_share(boundary, law) * (a.guide + part * (b.guide - a.guide))
    if boundary.load == DISPLACEMENT:
        x_out = course[LOAD, k]
    columns[0, k], columns[1, k], columns[2, k], columns[3, k] = x_in, x_out, f_in, f_out


@kernel
def sensor_share(boundary: Boundary, law: Law) -> float:
    """Return the share of the guide's friction that the load's force sensor does not feel."""
    before = law.load_friction.before_sensor_N
    if before == 0.0:
        return 0.0
    if boundary.load == DISPLACEMENT:
        return 1.0
    return before / guide_friction(law.load_friction)


@kernel
def law_of(rig: Rig, n: int) -> Law:
    """Return what of the rig holds at every step."""
    effects, bristles = rig.effects, rig.bristles
    stiffness = bristles.stiffness_N_per_mm
    travel = effects.presliding.length_mm
    limit = rig.preload_N * rig.friction_coefficient * rig.total_bend_rad
    damping = bristle_damping(bristles, rig.sheath_length_mm, limit, travel)
    viscous = effects.viscous_friction.coefficient_N_s_per_mm / n
    return Law(
        n,
        rig.preload_N,
        tendon_mass(bristles, rig.sheath_length_mm) / n,
        Bristle(stiffness / n, damping / n, viscous, travel),
        Bristle(stiffness, damping, 0.0, 0.0),
        effects.load_dependent_friction.exponent,
        effects.stribeck_friction,
        rig.load_stiffness_N_per_mm,
        effects.load_spring_nonlinearity,
        effects.load_friction,
        effects.load_inertia.mass_kg,
        effects.drive_friction.friction_N,
        effects.proximal_spring.stiffness_N_per_mm,
    )


@kernel
def lay_out(s: Floats, rig: Rig, n: int) -> None:
    """Set the tendon's segments."""
    for row in range(ROWS):
        for i in range(n + 2):
            s[PITCH * row + i] = 0.0
    bristles = rig.bristles
    relaxation_s = bristles.tendon_damping_N_s_per_mm * rig.sheath_length_mm
    relaxation_s /= rig.tendon_stiffness_N
    compliance = segment_compliances(rig, n)
    for j in range(n + 1):
        s[STIFFNESS + j] = 1.0 / compliance[j]
        s[DAMPING + j] = relaxation_s / compliance[j]


@kernel
def set_off(
    s: Floats,
    start: Floats,
    times: Floats,
    course: Floats,
    k: int,
    t: float,
    boundary: Boundary,
    law: Law,
) -> Ends:
    """Lay the nodes down at rest, their bristles holding what the tensions leave over.

    `start` holds positions and tensions, shape (2, n + 2) [mm, N]; returns the ends.
    """
    last = law.n + 1
    step = step_at(times, course, k, t, SHORTEST_S, law.n, boundary)
    for i in range(law.n + 2):
        s[Y + i] = s[Y_PAST + i] = start[0, i] - step.position
        s[T_PAST + i], s[T_BY_W + i] = start[1, i], 0.0
        s[V + i], s[V_PAST + i], s[W + i] = 0.0, 0.0, -step.speed
        s[Z_PAST + i] = 0.0
    if boundary.drive == DISPLACEMENT:
        s[W], s[V] = 0.0, step.speed
    balance(s, step, boundary, law)
    for i in range(1, law.n + 1):
        share = min(max(s[REST + i] / s[LIMIT + i], -1.0), 1.0)
        s[Z + i] = s[REST + i] / law.bristle.stiffness + share * law.bristle.travel
    s[Z] = s[REST] / law.end_bristle.stiffness
    s[Z + last] = s[REST + last] / law.end_bristle.stiffness
    return ends_after(s, step, law)


@kernel
def phase_of(s: Floats, law: Law) -> int:
    """Return +1 or −1 where all lumps slip alike, 0 otherwise."""
    pulled = released = 0
    for i in range(1, law.n + 1):
        longest = s[LIMIT + i] / law.bristle.stiffness + law.bristle.travel
        pulled += s[Z_NEW + i] > SLIDES * longest
        released += s[Z_NEW + i] < -SLIDES * longest
    return int(pulled == law.n) - int(released == law.n)
