"""Stability of sliding in the dynamic chain, without a simulation.

Bristles damped far above critical can drive a sliding tendon: their friction responds to a change
of tension σ1 v/g times as strongly as at rest; where the tension falls the damping σ1 (1 − z/z∞)
becomes negative. Friction that falls with speed is destabilising too. The growth of small
disturbances of sliding lumps follows from the eigenvalues of their linearised equations, frozen at
a moment: with all lumps sliding, and, in a dead band, with the half next to the drive.
"""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.effects.load_dependent_friction import load_factor
from tsas_cli.effects.load_spring_nonlinearity import spring_tangent
from tsas_cli.effects.stribeck_friction import stribeck_factor
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.bristles import TONNES_PER_KG, friction_now
from tsas_cli.physics.lugre.start import lugre_laws, segments
from tsas_cli.physics.lugre.state import LugreLaws
from tsas_cli.physics.phases import Phases
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

LUMPS = 24  # the growth is the same for 24 to 200
FOLDS = 3.0  # e-folds by which a disturbance may grow during its moment
SLOW = 0.02  # of the highest speed: below it the drive reverses
NUDGE = 1e-6  # of a state, for its derivative by central differences


@dataclass(frozen=True)
class Sliding:
    """One moment: the tension at the drive, its rate, the drive's speed, and its duration.

    `whole` is True where the whole tendon slides, False where only the half next to the drive does.
    """

    f_in_N: float
    f_in_rate: float
    speed_mm_s: float
    whole: bool
    lasts_s: float = math.inf


def growth_rate(rig: Rig, moment: Sliding) -> float:
    """Return the growth rate of the fastest disturbance of sliding lumps [1/s]; stable below 0."""
    lumps = _Lumps(rig, moment)
    slopes = np.empty((lumps.state.size, lumps.state.size))
    for i in range(lumps.state.size):
        nudge = np.zeros(lumps.state.size)
        nudge[i] = NUDGE
        slopes[:, i] = lumps.rates(lumps.state + nudge) - lumps.rates(lumps.state - nudge)
    return float(np.max(np.linalg.eigvals(slopes / (2.0 * NUDGE)).real))


class _Lumps:
    """The lumps that slide at a moment, next to the drive, and the equations of disturbances.

    The state is the disturbance of positions and of speeds, the deflection of the bristles, and
    with a load that has a mass, the disturbance of its position and speed.
    """

    def __init__(self, rig: Rig, moment: Sliding) -> None:
        self.laws = lugre_laws(rig, LUMPS, Boundary(DISPLACEMENT, SPRING))
        count = LUMPS if moment.whole else LUMPS // 2
        stiffness, damping = segments(rig, LUMPS)
        self.stiffness, self.damping = stiffness[: count + 1], damping[: count + 1]
        self.spring = spring_tangent(0.0, rig.load_stiffness_N_per_mm, self.laws.load.nonlinearity)
        self.load_mass = TONNES_PER_KG * self.laws.load.mass_kg if moment.whole else 0.0
        if moment.whole and self.load_mass == 0.0:  # in series with the last segment, undamped
            self.stiffness[-1] = 1.0 / (1.0 / self.stiffness[-1] + 1.0 / self.spring)
            self.damping[-1] = 0.0
        position: Floats = np.linspace(0.5, count - 0.5, count)
        direction = math.copysign(1.0, moment.speed_mm_s)
        self.friction = rig.friction_coefficient * rig.total_bend_rad / LUMPS
        decay: Floats = np.exp(-direction * self.friction * position)
        self.tension = moment.f_in_N * decay
        slower = 0.0 if moment.whole else 1.0 / (count + 0.5)  # the next lump sticks
        self.speed = moment.speed_mm_s * (1.0 - slower * position)
        limit, _, _ = sliding_friction(
            np.zeros(count), self.speed, self.tension, self.friction, self.laws
        )
        steady = limit / self.laws.lump.bristle.stiffness
        lag = steady * moment.f_in_rate / moment.f_in_N / np.abs(self.speed)
        deflection = direction * (steady + self.laws.lump.bristle.travel) * (1.0 - lag)
        load = np.zeros(2 if self.load_mass > 0.0 else 0)
        self.state = np.concatenate((np.zeros(2 * count), deflection, load))

    def rates(self, state: Floats) -> Floats:
        """Return the rates of a state, without the terms that do not depend on it."""
        position, speed, deflection = state[: 3 * self.speed.size].reshape(3, -1)
        x, v = state[3 * self.speed.size :] if self.load_mass > 0.0 else (0.0, 0.0)
        pull = -self.stiffness * np.diff(position, prepend=0.0, append=x)
        pull -= self.damping * np.diff(speed, prepend=0.0, append=v)
        sliding = self.speed + speed
        tension = self.tension + 0.5 * (pull[:-1] + pull[1:])
        _, rubbing, bristle_rate = sliding_friction(
            deflection, sliding, tension, self.friction, self.laws
        )
        faster = (-np.diff(pull) - rubbing) / self.laws.lump.mass
        rates = np.concatenate((speed, faster, bristle_rate))
        if self.load_mass == 0.0:
            return rates
        return np.append(rates, (v, (pull[-1] - self.spring * x) / self.load_mass))


@kernel
def sliding_friction(
    deflection: Floats, speed: Floats, tension: Floats, wrap: float, laws: LugreLaws
) -> tuple[Floats, Floats, Floats]:
    """Return each lump's limit of friction, its friction, and the rate of its deflection."""
    limit, force, rate = np.empty(speed.size), np.empty(speed.size), np.empty(speed.size)
    for i in range(speed.size):
        factor = stribeck_factor(speed[i], laws.lump.stribeck)
        factor *= load_factor(tension[i], laws.lump.friction_exponent)
        limit[i] = wrap * factor * abs(tension[i]) + laws.lump.drag_N
        force[i], rate[i] = friction_now(deflection[i], speed[i], limit[i], laws.lump.bristle)
    return limit, force, rate


@dataclass(frozen=True)
class Stability:
    """The fastest disturbance of all evaluated moments of a run."""

    growth_per_s: float
    moment: Sliding

    @property
    def unstable(self) -> bool:
        """Whether it grows by more than `FOLDS` e-folds during the moment."""
        return self.folds > FOLDS

    @property
    def folds(self) -> float:
        """E-folds of its growth during the moment."""
        return self.growth_per_s * self.moment.lasts_s


def moments(
    rig: Rig, time_s: Floats, x_in_mm: Floats, f_in_N: Floats, phase: Phases
) -> list[Sliding]:
    """Return the moments of a run at which the stability of sliding is evaluated.

    In full slip, in either direction, where the drive is fastest, where speed over tension is
    largest, and where friction falls fastest with speed; in dead bands where the slope of the
    tension is its median. Parameters are those of `stability`.
    """
    speed, rate = np.gradient(x_in_mm, time_s), np.gradient(f_in_N, time_s)
    lasts = np.abs(speed) / (np.abs(np.gradient(speed, time_s)) + 1e-300)
    moves = (speed != 0.0) & (f_in_N > 0.0)
    stribeck = rig.effects.stribeck_friction
    falls_fastest = (1.0 - 1.0 / stribeck.exponent) ** (1.0 / stribeck.exponent)
    steepest = falls_fastest * stribeck.velocity_mm_per_s
    chosen: list[tuple[int, bool]] = []
    for direction in (1, -1):
        slips = np.flatnonzero(moves & (phase == direction) & (np.sign(speed) == direction))
        if slips.size:
            fast = np.abs(speed[slips])
            most = [fast, fast / f_in_N[slips], -np.abs(fast - steepest)]
            chosen += [(int(slips[np.argmax(v)]), True) for v in most]
        fast_enough = np.abs(speed) > SLOW * np.max(np.abs(speed))
        band = np.flatnonzero(moves & fast_enough & (phase == 0) & (np.sign(speed) == direction))
        if band.size:
            steep = np.abs(rate[band] / speed[band])
            chosen.append((int(band[np.argsort(steep)[band.size // 2]]), False))
    return [
        Sliding(
            float(f_in_N[i]),
            float(rate[i]),
            float(speed[i]),
            whole,
            min(float(lasts[i]), float(time_s[-1] - time_s[0])),
        )
        for i, whole in dict.fromkeys(chosen)
    ]


def stability(
    rig: Rig, time_s: Floats, x_in_mm: Floats, f_in_N: Floats, phase: Phases
) -> Stability | None:
    """Return the stability of sliding over the speeds and tensions of a run.

    Parameters
    ----------
    rig
        The rig.
    time_s, x_in_mm, f_in_N, phase
        The run as simulated by the quasi-static model, shape (n,).

    Returns
    -------
        The least stable of its `moments`; None where the drive never moves under tension, or
        nothing rubs.
    """
    if rig.friction_coefficient * rig.total_bend_rad == 0.0:
        return None
    chosen = moments(rig, time_s, x_in_mm, f_in_N, phase)
    found = [Stability(growth_rate(rig, moment), moment) for moment in chosen]
    return max(found, key=lambda s: s.folds, default=None)
