"""The paper's rig, from Tables 1 and 2 and the text."""

import math
from collections.abc import Sequence

import numpy as np

from tsas_cli.effects import Effects
from tsas_cli.effects.stribeck_friction import StribeckFriction
from tsas_cli.effects.viscous_friction import ViscousFriction
from tsas_cli.paper import Paper
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.closed_form.capstan import slip_stiffness, speed_per_stiffness
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

GROUPS: Sequence[str] = ("a", "b", "c", "d")
PER_M = 1e-2  # of a mass per 100 m
RATE_HZ = 1000.0  # of what is simulated


def sheath_length_mm(paper: Paper, group: str) -> float:
    """Return L = R θ of a group of Table 2."""
    return paper.value(f"groups.{group}.radius_of_curvature") * paper.value(
        f"groups.{group}.total_bend"
    )


def tendon_stiffness(paper: Paper) -> float:
    """Return EA [N]."""
    area_mm2 = math.pi / 4.0 * paper.value("rig.tendon_diameter") ** 2
    return 1e3 * paper.value("rig.tendon_modulus") * area_mm2


def quasi_static_rig(paper: Paper, group: str = "a") -> Rig:
    """Return the rig of a group, with the length of Table 2 and no friction but Coulomb's."""
    return Rig(
        friction_coefficient=paper.value("rig.friction_coefficient"),
        tendon_stiffness_N=tendon_stiffness(paper),
        load_stiffness_N_per_mm=paper.value("rig.load_stiffness"),
        sheath_length_mm=sheath_length_mm(paper, group),
        total_bend_rad=paper.value(f"groups.{group}.total_bend"),
        preload_N=paper.value("rig.preload"),
    )


def bench_rig(paper: Paper) -> Rig:
    """Return the rig of Table 3 and Fig. 7: group a with the length that the text rounds."""
    return quasi_static_rig(paper)._replace(sheath_length_mm=paper.value("rig.sheath_length"))


def wrap_of(rig: Rig) -> float:
    """Return a = μθ."""
    return rig.friction_coefficient * rig.total_bend_rad


def stiffness_in_slip(rig: Rig, direction: float) -> float:
    """Return km of full slip towards the drive (1) or from it (−1) [N/mm], Eqs. (30), (32)."""
    sizes = rig.load_stiffness_N_per_mm, rig.sheath_length_mm, rig.tendon_stiffness_N
    return slip_stiffness(wrap_of(rig), direction, *sizes)


def dynamic_rig(paper: Paper, group: str, *, as_printed: bool) -> Rig:
    """Return the rig of a group with the constants of the dynamic model.

    Those of one lump in Table 1 become those of the whole sheath. The damping of the bristles is
    the critical one unless it is taken `as_printed`.
    """
    n = paper.value("rig.microelements")
    friction, at_rest = (
        paper.value(f"rig.{kind}_friction_coefficient") for kind in ("dynamic", "static")
    )
    return quasi_static_rig(paper, group)._replace(
        friction_coefficient=friction,
        effects=Effects(
            viscous_friction=ViscousFriction(n * paper.value("rig.viscous_friction")),
            stribeck_friction=StribeckFriction(
                at_rest / friction - 1.0, paper.value("rig.stribeck_velocity")
            ),
        ),
        bristles=Bristles(
            stiffness_N_per_mm=n * paper.value("rig.bristle_stiffness"),
            damping_N_s_per_mm=n * paper.value("rig.micro_damping") if as_printed else math.nan,
            tendon_mass_kg_per_m=PER_M * paper.value("rig.linear_density"),
            tendon_damping_N_s_per_mm=paper.value("rig.damping") / n,
        ),
    )


def motion(paper: Paper, group: str, *, periods: float = 2.0) -> tuple[Floats, DriveInput]:
    """Return the times [s], and the drive's motion A sin(ωt − π/2) + A of a group."""
    omega = paper.value(f"groups.{group}.angular_frequency")
    time_s = np.arange(0.0, periods * 2.0 * math.pi / omega, 1.0 / RATE_HZ)
    x_in = paper.value("rig.input_amplitude") * (1.0 - np.cos(omega * time_s))
    return time_s, DriveInput(x_in, time_s=time_s)


def kr_per_km(paper: Paper) -> float:
    """Return kr/km = 2π r1/(60 im) [mm/s per rpm], Eq. (25)."""
    return speed_per_stiffness(paper.value("rig.turntable_radius"), paper.value("rig.gear_ratio"))
