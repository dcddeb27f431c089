"""The drive's end: from the position sensor of the drive to the force sensor f_in.

x_in is prescribed, so all of this is explicit. The end of the tendon follows x_in through the
ripple of the gear and its play; the force sensor carries the tendon, the friction of the drive
and a spring to ground.
"""

from dataclasses import dataclass

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl
from tsas_studies.challenge.rig.eccentric import eccentric
from tsas_studies.challenge.rig.motions import Floats

PRESLIDING_MM = 1e-4
TONNE_PER_KG = 1e-3


@dataclass(frozen=True)
class DriveEnd:
    """What the drive's end is made of; all zeros are a perfect one."""

    # Backlash between the position sensor and the tendon, which starts in its middle.
    play_mm: float = 0.0
    # The gear turns unevenly: sine · sin(2πx/period) + cosine · (cos(2πx/period) − 1) is added, and
    # the second harmonic, shares of the first.
    ripple_sine_mm: float = 0.0
    ripple_cosine_mm: float = 0.0
    ripple_period_mm: float = 0.7095
    ripple_second_sine: float = 0.0
    ripple_second_cosine: float = 0.0
    compliance_mm_per_N: float = 0.0  # between the force sensor and the free tendon, in series
    spring_N_per_mm: float = 0.0  # stiffness of a spring from the tendon's end to ground
    friction_N: float = 0.0  # of the drive, felt by the force sensor
    # More such friction around one place of the stroke: a bell of this height and width.
    rough_N: float = 0.0
    rough_at_mm: float = 10.0
    rough_width_mm: float = 1.0
    # Friction of a pulley's bearing behind the force sensor, by so much of the tension.
    pulley_share: float = 0.0
    mass_kg: float = 0.0  # what moves with the tendon's end behind the force sensor
    damping_N_s_per_mm: float = 0.0  # of a damper from it to ground


def tendon_end(end: DriveEnd, x_in: Floats) -> Floats:
    """Return where the tendon's end is [mm] for each position of the drive, shape (m,)."""
    ripple, _ = eccentric(
        x_in,
        end.ripple_sine_mm,
        end.ripple_cosine_mm,
        end.ripple_period_mm,
        end.ripple_second_sine,
        end.ripple_second_cosine,
    )
    return followed(x_in + ripple, end.play_mm)


def sensed_force(end: DriveEnd, time_s: Floats, position: Floats, tension: Floats) -> Floats:
    """Return the force at the sensor [N] from the tendon's position and tension, shape (m,)."""
    bell = np.exp(-(((position - end.rough_at_mm) / end.rough_width_mm) ** 2))
    friction = end.friction_N + end.rough_N * bell + end.pulley_share * tension
    force = tension + friction * _bristle(position) + end.spring_N_per_mm * position
    speed = np.gradient(position, time_s)
    inertia = end.mass_kg * TONNE_PER_KG * np.gradient(speed, time_s)
    return np.asarray(force + end.damping_N_s_per_mm * speed + inertia)


@compiled
def followed(drive: Floats, play: float) -> Floats:
    """Return what is dragged along with this play, starting in its middle at 0."""
    out = np.empty(drive.size)
    last = 0.0
    for i in range(drive.size):
        last = min(max(last, drive[i] - 0.5 * play), drive[i] + 0.5 * play)
        out[i] = last
    return out


@compiled
def _bristle(position: Floats) -> Floats:
    """Return the friction state of the drive at each sample, from −1 to 1."""
    out = np.empty(position.size)
    phi, last = 0.0, 0.0
    for i in range(position.size):
        phi = dahl(position[i] - last, phi, PRESLIDING_MM, 0.0, 1.0)
        last = position[i]
        out[i] = phi
    return out
