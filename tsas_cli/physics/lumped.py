"""A tendon in its sheath as two springs with constant friction between them.

What a rigid-body simulation can hold of a rig: the sheath's friction acts on one point in the
middle of the tendon, with the loss of the whole sheath at one tension. Half of the tendon's
compliance lies before that point and half behind it.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

_SWEEPS, _SETTLED_MM = 1000, 1e-12


class Lumped(NamedTuple):
    """Springs, frictions, dampers and masses of a lumped tendon, in N and mm."""

    preload_N: float
    proximal_N_per_mm: float
    distal_N_per_mm: float
    load_N_per_mm: float
    beside_N_per_mm: float  # a spring at the drive
    drive_friction_N: float
    sheath_friction_N: float
    load_friction_N: float
    drive_damping_N_s_per_mm: float
    sheath_damping_N_s_per_mm: float
    load_damping_N_s_per_mm: float
    drive_mass_kg: float
    load_mass_kg: float


# The effects that a lumped tendon has too.
HELD = (
    "drive_compliance", "drive_damping", "drive_friction", "drive_inertia", "free_tendon",
    "load_damping", "load_friction", "load_inertia", "proximal_spring", "sheath_compression",
    "sheath_drag", "viscous_friction",
)  # fmt: skip


def lumped_of(rig: Rig, stroke_mm: float) -> Lumped:
    """Return the lumped tendon of a rig, with the friction at the mean tension of a stroke.

    The stroke pulls from the preload. The loss 2T·sinh(μθ/2) is that of the capstan over the whole
    sheath, where T is the tension in its middle.
    """
    e, EA, L = rig.effects, rig.tendon_stiffness_N, rig.sheath_length_mm
    half = 0.5 * L * (1.0 + e.sheath_compression.compliance_ratio)
    before = (half + e.free_tendon.proximal_length_mm) / EA + e.drive_compliance.compliance_mm_per_N
    behind = (half + e.free_tendon.distal_length_mm) / EA
    kL = rig.load_stiffness_N_per_mm
    whole = 1.0 / (before + behind + 1.0 / kL)
    tension = rig.preload_N + 0.5 * whole * stroke_mm
    return Lumped(
        preload_N=rig.preload_N,
        proximal_N_per_mm=1.0 / before,
        distal_N_per_mm=1.0 / behind,
        load_N_per_mm=kL,
        beside_N_per_mm=e.proximal_spring.stiffness_N_per_mm,
        drive_friction_N=e.drive_friction.friction_N,
        sheath_friction_N=2.0
        * tension
        * math.sinh(0.5 * rig.friction_coefficient * rig.total_bend_rad)
        + e.sheath_drag.force_N,
        load_friction_N=e.load_friction.after_sensor_N + e.load_friction.before_sensor_N,
        drive_damping_N_s_per_mm=e.drive_damping.coefficient_N_s_per_mm,
        sheath_damping_N_s_per_mm=e.viscous_friction.coefficient_N_s_per_mm,
        load_damping_N_s_per_mm=e.load_damping.coefficient_N_s_per_mm,
        drive_mass_kg=e.drive_inertia.mass_kg,
        load_mass_kg=e.load_inertia.mass_kg,
    )


def follow(lumped: Lumped, x_in_mm: Floats) -> tuple[Floats, Floats]:
    """Return f_in [N] and x_out [mm] of a lumped tendon that follows x_in without rate, shape (n,).

    Both points with friction rest until the springs at them exceed it.
    """
    k1, k2, kL = lumped.proximal_N_per_mm, lumped.distal_N_per_mm, lumped.load_N_per_mm
    middle = out = 0.0
    states = np.empty((x_in_mm.size, 2))
    for n, x in enumerate(x_in_mm):
        for _ in range(_SWEEPS):
            before = middle, out
            middle = _rests(middle, k1 * x + k2 * out, k1 + k2, lumped.sheath_friction_N)
            out = _rests(out, k2 * middle, k2 + kL, lumped.load_friction_N)
            if abs(middle - before[0]) + abs(out - before[1]) < _SETTLED_MM:
                break
        states[n] = middle, out
    tension = np.maximum(lumped.preload_N + k1 * (x_in_mm - states[:, 0]), 0.0)
    direction = np.sign(np.gradient(x_in_mm))
    beside = lumped.beside_N_per_mm * x_in_mm + lumped.drive_friction_N * direction
    return tension + beside, states[:, 1]


def _rests(position: float, force: float, stiffness: float, friction: float) -> float:
    """Return the position nearest to this one where friction holds a point on springs."""
    return min(max(position, (force - friction) / stiffness), (force + friction) / stiffness)
