"""A virtual tendon-sheath rig, independent of the product: its options, and its clean recording.

clean = simulate(Rig(distal_length_mm=60.0), sine())
columns = measure(clean, Sensors(), seed=1)          # in tsas_studies.challenge.rig.sensors
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from tsas_studies.challenge.rig import continuum, marching
from tsas_studies.challenge.rig.antagonist import Antagonist, Net, Tendons, run_pair
from tsas_studies.challenge.rig.courses import ONE, Course, course, settled
from tsas_studies.challenge.rig.drive_end import DriveEnd, sensed_force, tendon_end
from tsas_studies.challenge.rig.friction import Friction, over_time, over_travel
from tsas_studies.challenge.rig.give import Give, Path
from tsas_studies.challenge.rig.load_end import Load, LoadEnd
from tsas_studies.challenge.rig.motions import Floats, Motion
from tsas_studies.challenge.rig.restraint import Restraint, Spring
from tsas_studies.challenge.rig.surface import Surface


@dataclass(frozen=True)
class Rig:
    """What the rig is made of; the defaults are Table 1 and group a of Table 2 (Yang 2025).

    A profile or a course is a tuple of (position, value) pairs, linear in between and constant
    outside. The last fields are what else there is along the way, nothing by default; the
    antagonist and the load's end need a spring at the load.
    """

    friction_coefficient: float = 0.125
    total_bend_rad: float = math.pi
    sheath_length_mm: float = 250.0 * math.pi
    tendon_diameter_mm: float = 1.2
    tendon_modulus_GPa: float = 60.0
    preload_N: float = 25.0
    load_stiffness_N_per_mm: float = 1.579
    # "spring", or "force" and "displacement": what is prescribed at the distal end.
    load: str = "spring"
    # Tendon outside the sheath at the drive and at the load, in series with it.
    proximal_length_mm: float = 0.0
    distal_length_mm: float = 0.0
    # Relative curvature over the fraction of the sheath's length; only its shape counts.
    bend_profile: Course = ONE
    friction_course: Course = ONE  # factor on the friction over time [s]
    # Displacement over which friction reverses; small enough to pass for Coulomb.
    presliding_length_mm: float = 5e-6
    # How much more the sheath is compressed than the tendon stretches.
    sheath_compliance_ratio: float = 0.0
    # The tendon's force over its stretch s is F0 + (exp(stiffening · k s) − 1) / stiffening.
    stiffening_per_N: float = 0.0
    antagonist: Antagonist = field(default_factory=Antagonist)  # pulls the load back
    drive_end: DriveEnd = field(default_factory=DriveEnd)
    friction: Friction = field(default_factory=Friction)
    surface: Surface = field(default_factory=Surface)
    load_end: LoadEnd = field(default_factory=LoadEnd)
    load_pulley_loss: float = 0.0  # of a pulley at the load's end of the sheath, as μ times a wrap
    restraint: Restraint = field(default_factory=Restraint)
    give: Give = field(default_factory=Give)
    cells: int = 200

    @property
    def axial_stiffness(self) -> float:
        """Axial stiffness of the tendon times its length [N]."""
        return self.tendon_modulus_GPa * 1e3 * math.pi / 4.0 * self.tendon_diameter_mm**2


@dataclass(frozen=True, eq=False)
class CleanRun:
    """A recording without any sensor error: columns named as in format 1, on one fine clock."""

    columns: Mapping[str, Floats]

    @property
    def time_s(self) -> Floats:
        """Time of each sample [s]."""
        return self.columns["time_s"]


def simulate(
    rig: Rig, motion: Motion, *, distal: Floats | None = None, session_s: float = 0.0
) -> CleanRun:
    """Drive the rig through a motion, from rest at the preload with x_in = 0 mm.

    A motion that starts elsewhere is reached by one straight pull before its first sample; it is
    linear between its samples. With load "force" `distal` is the tension [N], with "displacement"
    x_out [mm] at each sample of the motion; it is left out for a spring. This run begins
    `session_s` after the first one. Columns: time_s, x_in_mm, x_out_mm, f_in_N, f_out_N.

    ValueError: the tendon goes slack, a step does not converge, or `distal` does not fit the load.
    """
    if (rig.load == "spring") != (distal is None):
        raise ValueError(f"load {rig.load!r} and distal values do not go together")
    if rig.load != "spring" and (rig.load_end, rig.restraint) != (LoadEnd(), Restraint()):
        raise ValueError(f"load {rig.load!r} has no load end")
    t, x_in = motion.time_s, motion.x_in_mm
    tendon = _tendon(rig)
    q = _distal_end(rig, t, tendon.c_out, distal)
    mu = rig.friction_coefficient * course(rig.friction_course, t)
    mu = mu * over_time(rig.friction, rig.total_bend_rad, t, session_s)
    mu = mu * over_travel(rig.friction, x_in)
    position = tendon_end(rig.drive_end, x_in)
    if rig.antagonist.preload_N > 0.0:
        return _with_antagonist(rig, motion, position, mu)
    t_in, t_out, u_end, guide, solved = marching.run(tendon, Path(rig.give), t, position, mu, q)
    _refuse_failed(t, t_in, solved)
    return CleanRun(
        {
            "time_s": t,
            "x_in_mm": x_in,
            "x_out_mm": u_end - tendon.c_out * (t_out - rig.preload_N),
            "f_in_N": sensed_force(rig.drive_end, t, position, t_in),
            "f_out_N": t_out - rig.load_end.friction_before_N * guide,
        }
    )


def _with_antagonist(rig: Rig, motion: Motion, position: Floats, mu: Floats) -> CleanRun:
    if rig.load != "spring" or rig.give != Give():
        raise ValueError("an antagonist needs a spring at the load and a firm path")
    t, other, F0 = motion.time_s, rig.antagonist, rig.preload_N
    between = replace(rig, load="displacement", load_end=LoadEnd(), restraint=Restraint())
    first = _tendon(replace(between, preload_N=F0 + other.preload_N))
    second = _tendon(replace(between, preload_N=other.preload_N))
    end = rig.load_end
    lost = settled(end.anchor_rate_N_per_s, end.anchor_settling_per_s, t)
    held = Load(end, rig.restraint, Spring(rig.load_stiffness_N_per_mm, F0))
    net = Net(F0 - lost, held)
    pair = Tendons(first, second, other.friction_ratio)
    signals, solved = run_pair(pair, net, t, position, mu)
    t_in, t_out, t_in_2, t_out_2, guide, y = signals
    _refuse_failed(t, t_in, solved)
    f_in = t_in - other.f_in_share * t_in_2
    return CleanRun(
        {
            "time_s": t,
            "x_in_mm": motion.x_in_mm,
            "x_out_mm": y,
            "f_in_N": sensed_force(rig.drive_end, t, position, f_in),
            "f_out_N": t_out - t_out_2 - end.friction_before_N * guide,
        }
    )


def _refuse_failed(t: Floats, t_in: Floats, solved: int) -> None:
    if solved < t.size:
        what = "the tendon is slack" if np.isfinite(t_in[solved]) else "the step fails"
        raise ValueError(f"{what} at {t[solved]:.6g} s")


def _tendon(rig: Rig) -> continuum.Tendon:
    EA, f = rig.axial_stiffness, rig.friction
    s = continuum.nodes(rig.sheath_length_mm, rig.cells)
    c_out, kL = rig.distal_length_mm / EA, rig.load_stiffness_N_per_mm
    p, r = _ends_of(rig.load, kL, c_out)
    share: Floats = np.diff(_edges(s)) / rig.sheath_length_mm
    return continuum.Tendon(
        bend=_bend_per_node(rig, s),
        k=EA / np.diff(s) / (1.0 + rig.sheath_compliance_ratio),
        c_in=rig.proximal_length_mm / EA + rig.drive_end.compliance_mm_per_N,
        p=p,
        r=r,
        preload=rig.preload_N,
        delta=rig.presliding_length_mm + f.presliding_mm + f.round_mm,
        c_out=c_out,
        load=Load(rig.load_end, rig.restraint, Spring(kL, rig.preload_N)),
        friction=f,
        viscous=f.viscous_N_s_per_mm * share,
        drag=f.drag_N * share,
        surface=rig.surface,
        stiffening=rig.stiffening_per_N,
    )


def _distal_end(rig: Rig, t: Floats, c_out: float, distal: Floats | None) -> Floats:
    """Return q of p T_out = q + r u_end, the free tendon at the load included."""
    F0, kL, end = rig.preload_N, rig.load_stiffness_N_per_mm, rig.load_end
    if distal is None:
        lost = settled(end.anchor_rate_N_per_s, end.anchor_settling_per_s, t)
        return F0 * (1.0 + kL * c_out) - lost
    distal = np.asarray(distal, dtype=float)
    return distal if rig.load == "force" else c_out * F0 - distal


def _ends_of(load: str, kL: float, c_out: float) -> tuple[float, float]:
    """Return p and r of p T_out = q + r u_end."""
    if load == "spring":
        return 1.0 + kL * c_out, kL
    if load == "force":
        return 1.0, 0.0
    if load == "displacement":
        return c_out, 1.0
    raise ValueError(f"load is {load!r}, expected spring, force or displacement")


def _edges(s: Floats) -> Floats:
    """Return the midpoints between nodes, and both ends."""
    return np.concatenate((s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]))


def _bend_per_node(rig: Rig, s: Floats) -> Floats:
    """Return the bend angle between the midpoints around each node [rad]."""
    fine = np.linspace(0.0, rig.sheath_length_mm, 20001)
    curvature = course(rig.bend_profile, fine / rig.sheath_length_mm)
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (curvature[1:] + curvature[:-1]))))
    edges = _edges(s)
    bend = np.diff(np.interp(edges, fine, angle / angle[-1]))
    at = 0.5 * (edges[1:] + edges[:-1]) / rig.sheath_length_mm
    bend = rig.total_bend_rad * bend * (1.0 + rig.friction.slope_along * (at - 0.5))
    bend[-1] += rig.load_pulley_loss / rig.friction_coefficient
    return np.asarray(bend)
