"""The slip chain: the distributed quasi-static model for any load, with friction that may vary.

The tendon is n nodes in a row, each with its share a/n of the wrap angle times friction, joined
by springs (half springs at both ends, which makes the mesh second order in 1/n). A node sticks
while the tensions on its two sides keep within the capstan ratio e^(±a/n), exactly Eq. (7) of
Yang 2025 for its bend; it slips in the direction that the larger one pulls. Each sample is one
static problem: find the set of slipping nodes (an active-set form of the semi-smooth Newton
method, started from the last sample's set). Between two sticking nodes the tensions are one
geometric series, so each step solves the chain exactly without a linear system.

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
TOLERANCE = 1e-12  # of the tension and of the displacement, for rounding


class Boundary(NamedTuple):
    """What drives the two ends: the kind of each, and the load spring's compliance [mm/N]."""

    drive: int
    load: int
    spring_compliance: float


@kernel
def passed_on(tension: float, ratio: float) -> float:
    """Return the tension behind a slipping node, e^(∓a/n) T; for T < 0 the ratio inverts."""
    return tension * ratio if tension >= 0.0 else tension / ratio


@kernel
def held_at_both_ends(p, q, x, T, slip, compliance, preload, ratio, signed):  # type: ignore[no-untyped-def]
    """Solve the segments p … q−1 between two nodes that keep their places.

    The tensions are T[p] times powers of the ratio, and stretch the segments by x[p] − x[q]. The
    ratio of a node depends on the sign of the tension, where that may be negative (`signed`).
    """
    inverse = 1.0 / ratio
    negative = signed and T[p] < 0.0
    for _ in range(2):
        share = 1.0
        weighted = compliance[p]
        total = compliance[p]
        for j in range(p + 1, q):
            share *= ratio if (slip[j] > 0) != negative else inverse
            weighted += compliance[j] * share
            total += compliance[j]
        T[p] = (x[p] - x[q] + preload * total) / weighted
        if not signed or (T[p] < 0.0) == negative:
            break
        negative = not negative
    for j in range(p + 1, q):
        x[j] = x[j - 1] - compliance[j - 1] * (T[j - 1] - preload)
        T[j] = T[j - 1] * (ratio if (slip[j] > 0) != negative else inverse)


@kernel
def pulled_at_load(p, x, T, slip, compliance, preload, ratio, force):  # type: ignore[no-untyped-def]
    """Solve the segments from the sticking node p to the load, whose force is given."""
    last = T.size - 1
    T[last] = force
    for j in range(last, p, -1):
        T[j - 1] = passed_on(T[j], ratio if slip[j] < 0 else 1.0 / ratio)
    for j in range(p, last + 1):
        x[j + 1] = x[j] - compliance[j] * (T[j] - preload)


@kernel
def pulled_at_drive(q, x, T, slip, compliance, preload, ratio, force):  # type: ignore[no-untyped-def]
    """Solve the segments from the drive, whose force is given, to the sticking node q."""
    T[0] = force
    for j in range(1, q):
        T[j] = passed_on(T[j - 1], ratio if slip[j] > 0 else 1.0 / ratio)
    for j in range(q - 1, -1, -1):
        x[j] = x[j + 1] + compliance[j] * (T[j] - preload)


@kernel
def revise(x, x_old, T, slip, ratio, scale):  # type: ignore[no-untyped-def]
    """Free the nodes whose tensions exceed the capstan ratio, hold those that slip backwards.

    Returns how many nodes changed.
    """
    changed = 0
    for i in range(1, x.size - 1):
        if slip[i] == 0:
            lower = passed_on(T[i - 1], ratio)
            upper = passed_on(T[i - 1], 1.0 / ratio)
            margin = TOLERANCE * abs(T[i - 1])
            if T[i] < lower - margin:
                slip[i] = 1
                changed += 1
            elif T[i] > upper + margin:
                slip[i] = -1
                changed += 1
        elif slip[i] * (x[i] - x_old[i]) < -TOLERANCE * scale:
            slip[i] = 0
            x[i] = x_old[i]
            changed += 1
    return changed


@kernel
def settle(x, x_old, T, slip, compliance, preload, ratio, boundary, end_force, scale):  # type: ignore[no-untyped-def]
    """Find the slipping nodes of one sample; return whether the set was found."""
    end = x.size - 1
    signed = boundary.load == FORCE
    for _ in range(4 * end + 20):
        p = 0
        while p < end:
            q = p + 1
            while q < end and slip[q] != 0:
                q += 1
            if q == end and boundary.load == FORCE:
                pulled_at_load(p, x, T, slip, compliance, preload, ratio, end_force)
            elif p == 0 and boundary.drive == FORCE:
                pulled_at_drive(q, x, T, slip, compliance, preload, ratio, end_force)
            else:
                held_at_both_ends(p, q, x, T, slip, compliance, preload, ratio, signed)
            p = q
        if revise(x, x_old, T, slip, ratio, scale) == 0:
            return True
    return False


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
        slipping nodes was not found.
    """
    m = drive.size
    x_in, x_out, f_in, f_out = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    phase = np.zeros(m, dtype=np.int8)
    compliance = segment_compliances(rig, boundary, n)
    x = np.zeros(n + 2)
    x_old = np.zeros(n + 2)
    T = np.full(n + 1, preload[0])
    slip = np.zeros(n + 2, dtype=np.int8)
    scale = rig.sheath_length_mm * rig.preload_N / rig.tendon_stiffness_N + 1e-6
    a, ratio = math.nan, math.nan
    for i in range(m):
        F0 = preload[i if preload.size > 1 else 0]
        if wrap[i if wrap.size > 1 else 0] != a:
            a = wrap[i if wrap.size > 1 else 0]
            ratio = math.exp(-a / n)
        end_force = 0.0
        if boundary.drive == FORCE:
            end_force = drive[i]
        else:
            x[0] = drive[i]
        if boundary.load == FORCE:
            end_force = load[i]
        else:
            x[n + 1] = load[i]
        found = settle(x, x_old, T, slip, compliance, F0, ratio, boundary, end_force, scale)
        phase[i] = phase_of(slip) if found else 3
        if boundary.load != FORCE and T[0] < 0.0:
            phase[i] = 2
            hang_slack(x, T, slip, compliance, F0)
        for j in range(1, n + 1):
            x_old[j] = x[j]
        x_in[i], f_in[i], f_out[i] = x[0], T[0], T[n]
        x_out[i] = (T[n] - F0) * boundary.spring_compliance + x[n + 1]
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
    first = slip[1]
    for i in range(2, slip.size - 1):
        if slip[i] != first:
            return 0
    return first


@kernel
def hang_slack(x, T, slip, compliance, preload):  # type: ignore[no-untyped-def]
    """Lay the tendon without tension against the load; the next pull finds all nodes slipping."""
    for j in range(T.size - 1, -1, -1):
        T[j] = 0.0
        if j > 0:
            x[j] = x[j + 1] - compliance[j] * preload
            slip[j] = 1
