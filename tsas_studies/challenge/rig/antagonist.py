"""A second tendon, which pulls the load back and is paid out by the drive as it winds the first.

Both tendons are continua as in `continuum.py`, each between two displacements: that of the drive
and that of the load, which counts the other way for the second one. Where the load is at the end of
a step follows from its balance, T1 − T2 = what holds it, by a secant method kept inside a bracket
(Illinois variant): T1 falls and T2 rises as the load goes towards the drive.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.continuum import Ends, State, Tendon
from tsas_studies.challenge.rig.load_end import AT_REST, Load, LoadState, extra_force, moved
from tsas_studies.challenge.rig.marching import at_rest, keep, stretched
from tsas_studies.challenge.rig.motions import Floats

BALANCED_N = 1e-5
MOST_TRIALS = 60
SHORTEST_PART = 1e-3
STIFFEST = 1e3  # N/mm, which the first step of the secant method takes for granted
FASTER = 4.0  # times the step before, as long as the balance is not bracketed


@dataclass(frozen=True)
class Antagonist:
    """The second tendon; without tension at rest there is none."""

    # Tension at rest; that of the first tendon at rest is so much higher than the load's.
    preload_N: float = 0.0
    friction_ratio: float = 1.0  # its coefficient of friction over the first one's
    # 1 where f_in is the torque of the drive, 0 where it is a load cell in the first tendon.
    f_in_share: float = 1.0


class Tendons(NamedTuple):
    """Both tendons, and the friction of the second one over that of the first."""

    first: Tendon
    second: Tendon
    ratio: float


class Net(NamedTuple):
    """What holds the load: preload [N] at each sample, and the load."""

    preload: Floats
    load: Load


class Pair(NamedTuple):
    """Displacements of both tendons within a step, and their tensions at drive and load."""

    converged: bool
    du: Floats
    du_2: Floats
    at_drive: float
    at_load: float
    at_drive_2: float
    at_load_2: float


@compiled
def run_pair(
    tendons: Tendons, net: Net, time: Floats, x_in: Floats, mu: Floats
) -> tuple[Floats, int]:
    """March through all samples, starting at rest with x_in = 0.

    Each tendon has a displacement given at its distal end; `time`, `x_in` and `mu` are of each
    sample, shape (m,) with m ≥ 2.

    Return the tensions of the first and of the second tendon, each at the drive and at the load
    [N], the state of the load's guide and the position of the load [mm], shape (6, m), and the
    number of samples before the first tendon went slack or a step did not converge.
    """
    m = x_in.size
    out = np.full((6, m), np.nan)
    first, second, _ = tendons
    one, two = at_rest(first.bend.size, first.surface), at_rest(second.bend.size, second.surface)
    load, slack = AT_REST, False
    x_before, mu_before, net_before = 0.0, mu[0], net.preload[0]
    for i in range(m):
        h = time[max(i, 1)] - time[max(i, 1) - 1]
        done, part = 0.0, 1.0
        while done < 1.0:
            to = min(1.0, done + part)
            x = x_before + to * (x_in[i] - x_before)
            now = mu_before + to * (mu[i] - mu_before)
            held = net_before + to * (net.preload[i] - net_before)
            step, winds = (to - done) * h, x_in[i] - x_before
            if slack:
                _hang(two, second, -x + (to - done) * winds, -load.y, winds)
            y, pair = _balance((one, two), tendons, net, held, load, x, now, step)
            if pair.converged:
                load = moved(net.load, load, y, step)
                keep(one, pair.du, first, step)
                keep(two, pair.du_2, second, step)
                slack = pair.at_drive_2 == 0.0 and pair.at_load_2 == 0.0
                done = to
            else:
                part *= 0.5
                if part < SHORTEST_PART:
                    return out, i
        x_before, mu_before, net_before = x_in[i], mu[i], net.preload[i]
        out[0, i], out[1, i] = pair.at_drive, pair.at_load
        out[2, i], out[3, i] = pair.at_drive_2, pair.at_load_2
        out[4, i], out[5, i] = load.guide, load.y
        if min(pair.at_drive, pair.at_load) <= 0.0:
            return out, i
    return out, m


@compiled
def _balance(
    states: tuple[State, State],
    tendons: Tendons,
    net: Net,
    held: float,
    load: LoadState,
    x: float,
    mu: float,
    h: float,
) -> tuple[float, Pair]:
    """Return where the load is after a step [mm], and what both tendons do there."""
    y = load.y
    pair = _pulled(states, tendons, x, y, mu, h)
    pull = _net_pull(pair, net, held, load, y, h)
    step = pull / STIFFEST
    other, pull_other, bracketed = y, pull, False
    for _ in range(MOST_TRIALS):
        if abs(pull) < BALANCED_N or not pair.converged:
            return y, pair
        trial = y - pull * (other - y) / (pull_other - pull) if bracketed else y + step
        pair = _pulled(states, tendons, x, trial, mu, h)
        new = _net_pull(pair, net, held, load, trial, h)
        if new * pull < 0.0:
            other, pull_other, bracketed = y, pull, True
        elif bracketed:
            pull_other *= 0.5
        else:
            fallen = pull - new
            far = new / fallen if fallen > 0.0 else FASTER
            step *= min(far, FASTER)
        y, pull = trial, new
    return y, Pair(False, pair.du, pair.du_2, 0.0, 0.0, 0.0, 0.0)


@compiled
def _net_pull(pair: Pair, net: Net, held: float, load: LoadState, y: float, h: float) -> float:
    """Return by how much the tendons pull the load more than it is held [N]."""
    force, _ = extra_force(net.load, load, y, h)
    spring = net.load.spring.stiffness_N_per_mm * y
    return float(pair.at_load - pair.at_load_2 - held - spring - force)


@compiled
def _pulled(
    states: tuple[State, State], tendons: Tendons, x: float, y: float, mu: float, h: float
) -> Pair:
    """Return what both tendons do for positions of drive and load [mm]."""
    (one, two), (first, second, ratio) = states, tendons
    good, du, t_in, t_out = stretched(one, first, Ends(x, mu, _distal(first, y)), h)
    if _is_slack(second, y - x):
        still = np.zeros(two.u.size)
        return Pair(good, du, still, t_in, t_out, 0.0, 0.0)
    ends = Ends(-x, ratio * mu, _distal(second, -y))
    good_2, du_2, t_in_2, t_out_2 = stretched(two, second, ends, h)
    return Pair(good and good_2, du, du_2, t_in, t_out, t_in_2, t_out_2)


@compiled
def _distal(tendon: Tendon, y: float) -> float:
    """Return q of p T_out = q + r u_end for a position of the load."""
    return tendon.c_out * tendon.preload - y


@compiled
def _is_slack(tendon: Tendon, longer: float) -> bool:
    """Return whether a tendon is shorter by more than its preload has stretched it [mm]."""
    given = np.sum(1.0 / tendon.k) + tendon.c_in + tendon.c_out
    return bool(longer <= -given * tendon.preload)


@compiled
def _hang(state: State, tendon: Tendon, at_drive: float, at_load: float, winds: float) -> None:
    """Lay a slack tendon straight from the end that does not take it up."""
    n = state.u.size
    if winds < 0.0:  # the drive winds the second tendon: it lies at the load
        state.u[n - 1] = at_load - tendon.c_out * tendon.preload
        for i in range(n - 2, -1, -1):
            state.u[i] = state.u[i + 1] - tendon.preload / tendon.k[i]
    else:
        state.u[0] = at_drive + tendon.c_in * tendon.preload
        for i in range(1, n):
            state.u[i] = state.u[i - 1] + tendon.preload / tendon.k[i - 1]
    for i in range(n):
        state.phi[i] = 1.0 if winds < 0.0 else -1.0
