"""The slip chain: the distributed quasi-static model for any load, with friction that may vary.

The tendon is n nodes in a row, each with its share a/n of the wrap angle times friction, joined
by springs; half springs at both ends make the mesh second order in 1/n (first order close to a
reversal, where the exact slope is infinite). A node sticks while the tensions on its two sides
keep within the capstan ratio e^(±a/n), exactly Eq. (7) of Yang 2025 for its bend; it slips in the
direction that the larger one pulls. Each sample is one static problem: find the set of slipping
nodes (an active-set form of the semi-smooth Newton method, started from the last sample's set).
Between two sticking nodes the tensions are one geometric series, so each step solves the chain
exactly without a linear system.

Signs: x grows towards the drive; node i moves towards the drive (+1) when T[i] = e^(−a/n) T[i−1].
Where the net tension is negative (a pair of antagonistic tendons seen as one), friction follows
its magnitude.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.effects.free_tendon import free_compliance
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]

DISPLACEMENT, FORCE = 0, 1  # what is given at an end
TOLERANCE = 1e-10  # of the tension and of a segment's elongation, for rounding
MOST_REVISIONS = 20  # of the slipping set, and two more for each node
SMALLEST_STEP = 2.0**-20  # of the way between two samples


class Boundary(NamedTuple):
    """What drives the two ends: the kind of each, and the load spring's compliance [mm/N]."""

    drive: int
    load: int
    spring_compliance: float


class Chain(NamedTuple):
    """The state of the chain; nodes count from 0 at the drive to n + 1 at the load."""

    x: Floats  # positions of the nodes [mm], shape (n + 2,)
    x_old: Floats  # the same when the last step had settled
    T: Floats  # tensions of the segments [N], shape (n + 1,)
    slip: Phases  # direction in which each node slips, 0 where it sticks
    compliance: Floats  # of the segments [mm/N]


class Ends(NamedTuple):
    """The ends at one moment: what is given there, the wrap angle times friction, the preload."""

    drive: float
    load: float
    wrap: float
    preload: float


@kernel
def passed_on(tension: float, ratio: float) -> float:
    """Return the tension behind a slipping node, e^(∓a/n) T; for T < 0 the ratio inverts."""
    return tension * ratio if tension >= 0.0 else tension / ratio


@kernel
def held_at_both_ends(p: int, q: int, chain: Chain, preload: float, ratio: float) -> None:
    """Solve the segments p … q−1 between two nodes that keep their places.

    The tensions are T[p] times powers of the ratio, and stretch the segments by x[p] − x[q]; the
    ratio turns round where the tension is negative.
    """
    x, T, slip, compliance = chain.x, chain.T, chain.slip, chain.compliance
    inverse = 1.0 / ratio
    negative = T[p] < 0.0
    for _ in range(2):
        share = 1.0
        weighted = compliance[p]
        total = compliance[p]
        for j in range(p + 1, q):
            share *= ratio if (slip[j] > 0) != negative else inverse
            weighted += compliance[j] * share
            total += compliance[j]
        T[p] = (x[p] - x[q] + preload * total) / weighted
        if (T[p] < 0.0) == negative:
            break
        negative = not negative
    tension, place = T[p], x[p]
    for j in range(p + 1, q):
        place -= compliance[j - 1] * (tension - preload)
        tension *= ratio if (slip[j] > 0) != negative else inverse
        x[j], T[j] = place, tension


@kernel
def pulled_at_load(p: int, chain: Chain, preload: float, ratio: float, force: float) -> None:
    """Solve the segments from the sticking node p to the load, whose force is given."""
    x, T, slip, compliance = chain.x, chain.T, chain.slip, chain.compliance
    last = T.size - 1
    T[last] = force
    for j in range(last, p, -1):
        T[j - 1] = passed_on(T[j], ratio if slip[j] < 0 else 1.0 / ratio)
    for j in range(p, last + 1):
        x[j + 1] = x[j] - compliance[j] * (T[j] - preload)


@kernel
def pulled_at_drive(q: int, chain: Chain, preload: float, ratio: float, force: float) -> None:
    """Solve the segments from the drive, whose force is given, to the sticking node q."""
    x, T, slip, compliance = chain.x, chain.T, chain.slip, chain.compliance
    T[0] = force
    for j in range(1, q):
        T[j] = passed_on(T[j - 1], ratio if slip[j] > 0 else 1.0 / ratio)
    for j in range(q - 1, -1, -1):
        x[j] = x[j + 1] + compliance[j] * (T[j] - preload)


@kernel
def revise(chain: Chain, ratio: float, scale: float) -> bool:
    """Free the nodes whose tensions exceed the capstan ratio, hold those that slip backwards.

    Returns whether any node was wrong.
    """
    x, x_old, T, slip = chain.x, chain.x_old, chain.T, chain.slip
    wrong = False
    for i in range(1, x.size - 1):
        if slip[i] == 0:
            margin = TOLERANCE * abs(T[i - 1])
            if T[i] < passed_on(T[i - 1], ratio) - margin:
                slip[i] = 1
                wrong = True
            elif T[i] > passed_on(T[i - 1], 1.0 / ratio) + margin:
                slip[i] = -1
                wrong = True
        elif slip[i] * (x[i] - x_old[i]) < -TOLERANCE * scale:
            slip[i] = 0
            x[i] = x_old[i]
            wrong = True
    return wrong


@kernel
def settle(chain: Chain, ends: Ends, boundary: Boundary, scale: float) -> bool:
    """Find the slipping nodes for given ends; return whether the set was found."""
    x, slip = chain.x, chain.slip
    n = x.size - 2
    ratio = math.exp(-ends.wrap / n)
    if boundary.drive == DISPLACEMENT:
        x[0] = ends.drive
    if boundary.load == DISPLACEMENT:
        x[n + 1] = ends.load
    for _ in range(MOST_REVISIONS + 2 * n):
        p = 0
        while p <= n:
            q = p + 1
            while q <= n and slip[q] != 0:
                q += 1
            if q == n + 1 and boundary.load == FORCE:
                pulled_at_load(p, chain, ends.preload, ratio, ends.load)
            elif p == 0 and boundary.drive == FORCE:
                pulled_at_drive(q, chain, ends.preload, ratio, ends.drive)
            else:
                held_at_both_ends(p, q, chain, ends.preload, ratio)
            p = q
        if not revise(chain, ratio, scale):
            return True
    return False


@kernel
def advance(chain: Chain, start: Ends, end: Ends, boundary: Boundary, scale: float) -> bool:
    """Move the ends from one sample to the next, in smaller steps where one is too large.

    The model does not depend on the rate, only on the path: a straight line between samples.
    Returns whether every step settled.
    """
    x, x_old, slip = chain.x, chain.x_old, chain.slip
    done, step = 0.0, 1.0
    while done < 1.0:
        to = min(done + step, 1.0)
        if settle(chain, between(start, end, to), boundary, scale):
            x_old[:] = x
            done = to
            step *= 2.0
        else:
            x[:] = x_old
            slip[:] = 0
            step *= 0.5
            if step < SMALLEST_STEP:
                return False
    return True


@kernel
def between(start: Ends, end: Ends, part: float) -> Ends:
    """Return the ends at a part of the way; the last one exactly."""
    if part == 1.0:
        return end
    return Ends(
        start.drive + part * (end.drive - start.drive),
        start.load + part * (end.load - start.load),
        start.wrap + part * (end.wrap - start.wrap),
        start.preload + part * (end.preload - start.preload),
    )


@kernel
def slip_chain(
    drive: Floats, load: Floats, wrap: Floats, preload: Floats, rig: Rig, boundary: Boundary, n: int
) -> tuple[Floats, Floats, Floats, Floats, Phases]:
    """Follow the motion of both ends, starting from rest at the preload.

    Parameters
    ----------
    drive
        What is given at the drive, shape (m,): displacement [mm], or tension [N].
    load
        What is given at the load, shape (m,): tension [N] or displacement [mm]; zeros for a spring.
    wrap, preload
        Friction times bend a = μθ [1] and F0 [N], shape (m,), or (1,) where they stay the same.
    rig
        The rig; friction, bend and preload are taken from the arrays.
    boundary
        What is given at the ends.
    n
        Number of nodes.

    Returns
    -------
    x_in, x_out, f_in, f_out, phase
        Shape (m,) [mm, mm, N, N]; the phase is +1 where the whole tendon slips in contraction, −1
        in loosening, 0 where a part of it sticks, 2 where it hangs slack, 3 where the set of
        slipping nodes was not found and the sample is not to be trusted.
    """
    m = drive.size
    x_in, x_out, f_in, f_out = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    phase = np.zeros(m, dtype=np.int8)
    chain = Chain(
        np.zeros(n + 2),
        np.zeros(n + 2),
        np.full(n + 1, preload[0]),
        np.zeros(n + 2, dtype=np.int8),
        segment_compliances(rig, boundary, n),
    )
    x, T = chain.x, chain.T
    scale = rig.sheath_length_mm * rig.preload_N / rig.tendon_stiffness_N / n + 1e-9
    rest_drive = preload[0] if boundary.drive == FORCE else 0.0
    rest_load = preload[0] if boundary.load == FORCE else 0.0
    before = Ends(rest_drive, rest_load, wrap[0], preload[0])
    for i in range(m):
        now = Ends(drive[i], load[i], wrap[i % wrap.size], preload[i % preload.size])
        found = advance(chain, before, now, boundary, scale)
        before = now
        phase[i] = phase_of(chain.slip) if found else 3
        if boundary.load != FORCE and T[0] < 0.0:
            phase[i] = 2
            hang_slack(chain, now.preload)
            chain.x_old[:] = x
        x_in[i], f_in[i], f_out[i] = x[0], T[0], T[n]
        x_out[i] = (T[n] - now.preload) * boundary.spring_compliance + x[n + 1]
    return x_in, x_out, f_in, f_out, phase


@kernel
def segment_compliances(rig: Rig, boundary: Boundary, n: int) -> Floats:
    """Return the compliance of each of the n + 1 segments, shape (n + 1,) [mm/N]."""
    EA = rig.tendon_stiffness_N
    free = rig.effects.free_tendon
    compliance = np.full(n + 1, rig.sheath_length_mm / n / EA)
    compliance[0] = 0.5 * compliance[0] + free_compliance(free.proximal_length_mm, EA)
    compliance[n] = 0.5 * compliance[n] + free_compliance(free.distal_length_mm, EA)
    compliance[n] += boundary.spring_compliance
    return compliance


@kernel
def phase_of(slip: Phases) -> int:
    """Return +1 or −1 where all nodes slip alike, 0 otherwise."""
    first: int = slip[1]
    for i in range(2, slip.size - 1):
        if slip[i] != first:
            return 0
    return first


@kernel
def hang_slack(chain: Chain, preload: float) -> None:
    """Lay the tendon without tension against the load; the next pull finds all nodes slipping."""
    x, T, slip, compliance = chain.x, chain.T, chain.slip, chain.compliance
    for j in range(T.size - 1, -1, -1):
        T[j] = 0.0
        if j > 0:
            x[j] = x[j + 1] - compliance[j] * preload
            slip[j] = 1
