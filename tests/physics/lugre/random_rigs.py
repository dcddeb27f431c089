"""Rigs, meshes and motions at random, over ranges far wider than any rig's."""

import math
from typing import NamedTuple

import numpy as np

from tests.physics.lugre.lumps import run
from tsas_cli.effects import (
    Effects,
    LoadFriction,
    LoadInertia,
    Presliding,
    StribeckFriction,
    ViscousFriction,
)
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import Progress
from tsas_cli.physics.lugre.stability import stability
from tsas_cli.physics.response import TOLERANCE, simulate
from tsas_cli.physics.rig import Rig

SAMPLES = 1500
USUAL, TIGHT = TOLERANCE, 2e-7


class Case(NamedTuple):
    rig: Rig
    lumps: int
    time_s: np.ndarray
    x_in_mm: np.ndarray


class Followed(NamedTuple):
    columns: np.ndarray
    progress: Progress
    finished: bool


def random_case(seed):
    rng = np.random.default_rng(seed)

    def between(low, high):
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    def sometimes(chance, effect):
        return effect if rng.random() < chance else type(effect)()

    rig = Rig(
        friction_coefficient=between(0.02, 0.4),
        tendon_stiffness_N=between(1e4, 1e6),
        load_stiffness_N_per_mm=between(0.05, 50.0),
        sheath_length_mm=between(100.0, 3000.0),
        total_bend_rad=between(0.3, 4.0 * math.pi),
        preload_N=between(1.0, 200.0),
        effects=Effects(
            viscous_friction=ViscousFriction(between(1e-3, 0.5)),
            stribeck_friction=sometimes(
                0.5,
                StribeckFriction(rng.uniform(0.0, 0.3), between(0.01, 20.0), rng.uniform(1.0, 3.0)),
            ),
            presliding=sometimes(0.3, Presliding(between(1e-3, 0.1))),
            load_friction=sometimes(0.2, LoadFriction(rng.uniform(0.0, 2.0), 0.0)),
            load_inertia=sometimes(0.2, LoadInertia(between(0.01, 2.0))),
        ),
        bristles=Bristles(
            stiffness_N_per_mm=between(200.0, 5e5),
            tendon_mass_kg_per_m=between(5e-4, 0.05),
            tendon_damping_N_s_per_mm=between(1e-4, 0.1),
        ),
    )
    lumps, amplitude, omega = int(rng.integers(5, 100)), between(0.1, 20.0), between(0.2, 20.0)
    time_s = np.linspace(0.0, 3.0 * math.pi / omega, SAMPLES)
    x_in = amplitude * (1.0 - np.cos(omega * time_s))
    if rng.random() < 0.4:
        x_in += 0.3 * amplitude * (1.0 - np.cos(5.0 * omega * time_s))
    return Case(rig, lumps, time_s, x_in)


def followed(case, tolerance):
    how = {"rig": case.rig, "n": case.lumps, "tolerance": tolerance}
    output, progress = run(case.x_in_mm, case.time_s, **how)
    finished = progress.reached_s >= case.time_s[-1] * (1.0 - 1e-12)
    return Followed(np.array(output[:4]), progress, finished)


def is_unstable(case):
    quasi = simulate(case.rig, DriveInput(case.x_in_mm, time_s=case.time_s))
    found = stability(case.rig, case.time_s, case.x_in_mm, quasi.f_in_N, quasi.phase)
    return found is not None and found.unstable


def largest_difference(one, other):
    """Return the largest difference of any channel, over its range in the second.

    A range counts as at least a hundredth of the drive's travel, or of the largest tension.
    """
    a, b = one.columns, other.columns
    least = 0.01 * np.array([np.ptp(b[0]), np.ptp(b[0]), np.max(b[2]), np.max(b[2])])
    return float(np.max(np.max(np.abs(a - b), axis=1) / np.maximum(np.ptp(b, axis=1), least)))
