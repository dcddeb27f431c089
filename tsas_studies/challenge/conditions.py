"""The conditions of a case: what its rig has beside what is hidden and white noise.

clean      white noise alone
slow       also slow noise as large as the white one
realistic  what every real rig has a little of: friction that differs from run to run and along the
           sheath, slow noise, crosstalk and curvature of the force sensors

None of it is a cause to be named. Where a hidden cause sets the same, its value holds.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

Conditions = Literal["clean", "slow", "realistic"]
CONDITIONS: tuple[Conditions, ...] = ("clean", "slow", "realistic")
SLOW_S = 1.0  # memory of the slow noise
WHITE_N, WHITE_MM = 0.1, 0.01
FRICTION = 0.015  # by how much friction differs from run to run, at most
ALONG = 0.15  # from one end of the sheath to the other
CROSSTALK = 0.003
CURVATURE_PER_N = 0.003 / 60.0  # bends a scale by 0.3 % at the largest force


@dataclass(frozen=True)
class Nuisance:
    """What a case's rig has beside what is hidden; the defaults are nothing."""

    friction: Mapping[str, float] = field(default_factory=dict)  # factor on μ by run
    # Friction at the load's end of the sheath less that at the drive's, relative to the mean.
    along: float = 0.0
    f_in_of_f_out: float = 0.0  # crosstalk of the force sensors
    f_out_of_f_in: float = 0.0
    f_in_per_N: float = 0.0  # curvature of their scales
    f_out_per_N: float = 0.0
    slow_N: float = 0.0  # slow noise of the forces and of x_out
    slow_mm: float = 0.0


def kind_label(kind: str, conditions: Conditions) -> str:
    """Return a kind of cases in words, under conditions that are not clean by name."""
    return kind if conditions == "clean" else f"{conditions} {kind}"


def drawn_nuisance(
    conditions: Conditions, runs: Iterable[str], rng: np.random.Generator
) -> Nuisance:
    """Draw what the rig of a case has under these conditions."""
    if conditions == "clean":
        return Nuisance()
    if conditions == "slow":
        return Nuisance(slow_N=WHITE_N, slow_mm=WHITE_MM)

    def up_to(most: float) -> float:
        return float(rng.uniform(-most, most))

    return Nuisance(
        friction={run: 1.0 + up_to(FRICTION) for run in runs},
        along=float(rng.choice((-ALONG, ALONG))),
        f_in_of_f_out=up_to(CROSSTALK),
        f_out_of_f_in=up_to(CROSSTALK),
        f_in_per_N=up_to(CURVATURE_PER_N),
        f_out_per_N=up_to(CURVATURE_PER_N),
        slow_N=0.5 * WHITE_N,
        slow_mm=0.5 * WHITE_MM,
    )


def spoiled(nuisance: Nuisance, run: str, rig: Rig, sensors: Sensors) -> tuple[Rig, Sensors]:
    """Return the rig and its sensors in a run under these conditions."""
    n = nuisance
    rig = replace(
        rig,
        friction_coefficient=rig.friction_coefficient * n.friction.get(run, 1.0),
        friction=rig.friction._replace(slope_along=n.along),
    )
    f_in, f_out, x_out = sensors.f_in_N, sensors.f_out_N, sensors.x_out_mm
    f_in = replace(f_in, curvature=n.f_in_per_N, slow_noise=n.slow_N, slow_time_s=SLOW_S)
    f_out = replace(f_out, curvature=n.f_out_per_N, slow_noise=n.slow_N, slow_time_s=SLOW_S)
    return rig, replace(
        sensors,
        f_in_of_f_out=n.f_in_of_f_out,
        f_out_of_f_in=n.f_out_of_f_in,
        f_in_N=f_in,
        f_out_N=f_out,
        x_out_mm=replace(x_out, slow_noise=n.slow_mm, slow_time_s=SLOW_S),
    )
