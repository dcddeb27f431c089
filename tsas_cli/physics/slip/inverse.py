"""The inverse model: the drive's position for a reference force at the load.

For constant friction it is Eq. (22) of Yang 2025, x_in = (Fd − F0)/kL + Δs(Fd, phase) − F0 L/(EA).
Here the slip chain itself is inverted, sample by sample, so that it is valid for every effect and
simulation and inverse share one law: the tendon's end is moved from its last position until the
chain has the force (regula falsi, Illinois variant, since the force has kinks). At a reversal of
the reference that is a jump over the dead band.

Losses that depend on speed or time are given with the samples, so that a path can be iterated with
the speeds of the one before.
"""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.course import PULLED, RELEASED, Losses, losses_of
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import advance
from tsas_cli.physics.slip.outputs import tension_at_sensor
from tsas_cli.physics.slip.state import (
    POSITION,
    ROWS,
    TENSION,
    Moment,
    SlipLaws,
    chain_at_rest,
    slip_laws,
)
from tsas_cli.support.arrays import Floats

EXACT_N = 1e-7  # tolerance of the force
MOST_TRIALS = 200  # positions of the tendon's end for one sample


@kernel
def inverse_chain(
    wanted_N: Floats, losses: Floats, step_s: float, rig: Rig, n: int
) -> tuple[Floats, Floats, int]:
    """Return the path of the tendon's end at the drive for a reference force at the load.

    Parameters
    ----------
    wanted_N
        Force at the load's sensor, shape (m,), positive.
    losses
        Losses at each sample, as returned by `ends.losses_over`, shape (4, m).
    step_s
        Time between samples.
    rig
        The rig, at rest at its preload before the first sample.
    n
        Number of nodes.

    Returns
    -------
    path, tension, unreachable
        Position of the tendon's end [mm] and its tension [N], shape (m,) each, and the number of
        samples whose force was not reached.
    """
    m = wanted_N.size
    path, tension = np.empty(m), np.empty(m)
    chain, saved = chain_at_rest(rig, n), np.empty(ROWS * PITCH)
    laws = slip_laws(rig, n, Boundary(DISPLACEMENT, SPRING))
    before = Moment(0.0, 0.0, Losses(losses[PULLED, 0], losses[RELEASED, 0], 0.0, 0.0), np.inf)
    unreachable = 0
    for i in range(m):
        step = np.inf if i == 0 else step_s
        now = Moment(before.drive, 0.0, losses_of(losses, i), step)
        before, found = reach_force(chain, saved, before, now, wanted_N[i], laws)
        unreachable += not found
        path[i], tension[i] = chain[POSITION], chain[TENSION]
    return path, tension, unreachable


@kernel
def reach_force(
    chain: Floats,
    saved: Floats,
    before: Moment,
    now: Moment,
    wanted_N: float,
    laws: SlipLaws,
) -> tuple[Moment, bool]:
    """Move the tendon's end, in place, until the tension at the load's sensor is a given one.

    Returns the moment there and whether the force was reached; where not, the chain is unchanged.
    """
    copy_rows(chain, saved, laws.n)
    b, error_b = now.drive, wanted_N - force_at_sensor(chain, before, now, laws)
    if abs(error_b) <= EXACT_N:
        return now, True
    step, bracketed = error_b / laws.load.stiffness_N_per_mm, False
    a, error_a = b, error_b
    for _ in range(MOST_TRIALS):
        x = a - error_a * (b - a) / (error_b - error_a) if bracketed else b + step
        copy_rows(saved, chain, laws.n)
        now = Moment(x, now.load, now.losses, now.step_s)
        error = wanted_N - force_at_sensor(chain, before, now, laws)
        if abs(error) <= EXACT_N:
            return now, True
        if error * error_b < 0.0:
            a, error_a, bracketed = b, error_b, True
        elif bracketed:
            error_a *= 0.5  # of the retained end (Illinois)
        else:
            change = error_b - error  # in a dead band only rounding
            part = error / change if abs(change) > EXACT_N else 2.0
            step *= min(part, 2.0) if part > 0.0 else 2.0
        b, error_b = x, error
    copy_rows(saved, chain, laws.n)
    return before, False


@kernel
def copy_rows(source: Floats, target: Floats, n: int) -> None:
    """Copy the state of the nodes."""
    for row in range(ROWS):
        for j in range(n + 2):
            target[PITCH * row + j] = source[PITCH * row + j]


@kernel
def force_at_sensor(chain: Floats, before: Moment, now: Moment, laws: SlipLaws) -> float:
    """Return the tension at the load's sensor after a move; infinite if it does not converge."""
    if not advance(chain, before, now, laws):
        return np.inf
    return tension_at_sensor(chain, now, laws)
