"""The inverse model: where the drive has to be so that the load feels a wanted force.

For constant friction it is Eq. (22) of Yang 2025, x_in = (Fd − F0)/kL + Δs(Fd, phase) − F0 L/(EA).
Here the slip chain itself is inverted, sample by sample, so that it holds for every effect and
there is one law for simulation and inverse: from where the tendon's end was it is moved until the
chain answers with the force (regula falsi, Illinois variant, since the answer has kinks). At a turn
of the wanted force that is a jump over the dead band.

What depends on speed or time is given with the samples, so that a path can be found again with
the speeds of the one before.
"""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.course import PULLED, RELEASED, Losses, losses_of
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import advance, tension_at_sensor
from tsas_cli.physics.slip.start import chain_at_rest, slip_laws
from tsas_cli.physics.slip.state import POSITION, ROWS, TENSION, Floats, Moment, SlipLaws

EXACT_N = 1e-7  # of the wanted force
MOST_TRIALS = 200  # of places of the tendon's end for one sample


@kernel
def inverse_chain(
    wanted_N: Floats, losses: Floats, step_s: float, rig: Rig, n: int
) -> tuple[Floats, Floats, int]:
    """Find the path of the tendon's end at the drive that gives the load a wanted force.

    Parameters
    ----------
    wanted_N
        Force at the load's sensor, shape (m,), positive.
    losses
        Those of the tendon at each sample, as `ends.losses_over` returns them, shape (4, m).
    step_s
        Time between samples.
    rig
        The rig, at rest at its preload before the first sample.
    n
        Number of nodes.

    Returns
    -------
    path, tension, missed
        Place of the tendon's end [mm] and its tension [N], shape (m,) each, and the number of
        samples whose force was not met.
    """
    m = wanted_N.size
    path, tension = np.empty(m), np.empty(m)
    chain, kept = chain_at_rest(rig, n), np.empty(ROWS * PITCH)
    laws = slip_laws(rig, n, Boundary(DISPLACEMENT, SPRING))
    before = Moment(0.0, 0.0, Losses(losses[PULLED, 0], losses[RELEASED, 0], 0.0, 0.0), np.inf)
    missed = 0
    for i in range(m):
        step = np.inf if i == 0 else step_s
        now = Moment(before.drive, 0.0, losses_of(losses, i), step)
        before, found = reach_force(chain, kept, before, now, wanted_N[i], laws)
        missed += not found
        path[i], tension[i] = chain[POSITION], chain[TENSION]
    return path, tension, missed


@kernel
def reach_force(
    chain: Floats,
    kept: Floats,
    before: Moment,
    now: Moment,
    wanted_N: float,
    laws: SlipLaws,
) -> tuple[Moment, bool]:
    """Move the tendon's end until the load's sensor feels a force; the chain stays there.

    Returns the moment there and whether the force was met; where it was not, nothing moves.
    """
    copy_rows(chain, kept, laws.n)
    b, off_b = now.drive, wanted_N - force_at_sensor(chain, before, now, laws)
    if abs(off_b) <= EXACT_N:
        return now, True
    step, bracketed = off_b / laws.load.stiffness_N_per_mm, False
    a, off_a = b, off_b
    for _ in range(MOST_TRIALS):
        x = a - off_a * (b - a) / (off_b - off_a) if bracketed else b + step
        copy_rows(kept, chain, laws.n)
        now = driven_to(now, x)
        off = wanted_N - force_at_sensor(chain, before, now, laws)
        if abs(off) <= EXACT_N:
            return now, True
        if off * off_b < 0.0:
            a, off_a, bracketed = b, off_b, True
        elif bracketed:
            off_a *= 0.5  # the end that stays counts half (Illinois)
        else:
            nearer = off_b - off  # in a dead band no more than rounding
            part = off / nearer if abs(nearer) > EXACT_N else 2.0
            step *= min(part, 2.0) if part > 0.0 else 2.0
        b, off_b = x, off
    copy_rows(kept, chain, laws.n)
    return before, False


@kernel
def driven_to(now: Moment, x: float) -> Moment:
    """Return the same moment with the tendon's end at another place."""
    return Moment(x, now.load, now.losses, now.step_s)


@kernel
def copy_rows(source: Floats, target: Floats, n: int) -> None:
    """Copy the state of the nodes."""
    for row in range(ROWS):
        for j in range(n + 2):
            target[PITCH * row + j] = source[PITCH * row + j]


@kernel
def force_at_sensor(chain: Floats, before: Moment, now: Moment, laws: SlipLaws) -> float:
    """Return what the load's sensor feels after the tendon's end has moved; infinite if lost."""
    if not advance(chain, before, now, laws):
        return np.inf
    return tension_at_sensor(chain, now, laws)
