"""A virtual tendon-sheath rig, independent of the product: its options, and its clean recording.

clean = simulate(Rig(distal_length_mm=60.0), sine())
columns = measure(clean, Sensors(), seed=1)          # in tsas_cli.challenge.rig.sensors
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tsas_cli.challenge.rig import continuum
from tsas_cli.challenge.rig.motions import Floats, Motion

Course = tuple[tuple[float, float], ...]
ONE: Course = ((0.0, 1.0),)


@dataclass(frozen=True)
class Rig:
    """What the rig is made of; the defaults are Table 1 and group a of Table 2 (Yang 2025).

    A profile or a course is a tuple of (position, value) pairs, linear in between and constant
    outside.

    Attributes
    ----------
    proximal_length_mm, distal_length_mm
        Tendon outside the sheath at the drive and at the load, in series with it.
    bend_profile
        Relative curvature over the fraction of the sheath's length; only its shape counts.
    friction_course, bend_course
        Factors on the friction and on the bend over time [s].
    preload_course
        Factor on the preload of the load spring over time [s] (its anchor gives way); the
        tendon's length at rest stays that of the first preload.
    load
        "spring", or "force" and "displacement": what is prescribed at the distal end.
    presliding_length_mm
        Displacement over which friction turns round; small enough to pass for Coulomb.
    """

    friction_coefficient: float = 0.125
    total_bend_rad: float = math.pi
    sheath_length_mm: float = 250.0 * math.pi
    tendon_diameter_mm: float = 1.2
    tendon_modulus_GPa: float = 60.0
    preload_N: float = 25.0
    load_stiffness_N_per_mm: float = 1.579
    load: str = "spring"
    proximal_length_mm: float = 0.0
    distal_length_mm: float = 0.0
    bend_profile: Course = ONE
    friction_course: Course = ONE
    bend_course: Course = ONE
    preload_course: Course = ONE
    presliding_length_mm: float = 5e-6
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


def simulate(rig: Rig, motion: Motion, *, distal: Floats | None = None) -> CleanRun:
    """Drive the rig through a motion, from rest at the preload with x_in = 0 mm.

    A motion that starts elsewhere is reached by one straight pull before its first sample.

    Parameters
    ----------
    rig
        The rig.
    motion
        x_in over time; it is linear between its samples.
    distal
        With load "force" the tension [N], with "displacement" x_out [mm] at each sample of the
        motion; left out for a spring.

    Returns
    -------
    CleanRun
        time_s, x_in_mm, x_out_mm, f_in_N, f_out_N.

    Raises
    ------
    ValueError
        The tendon goes slack, a step does not converge, or `distal` does not fit the load.
    """
    if (rig.load == "spring") != (distal is None):
        raise ValueError(f"load {rig.load!r} and distal values do not go together")
    t, x_in = motion.time_s, motion.x_in_mm
    c_out = rig.distal_length_mm / rig.axial_stiffness
    q, p, r = _distal_end(rig, t, c_out, distal)
    s = continuum.nodes(rig.sheath_length_mm, rig.cells)
    tendon = continuum.Tendon(
        bend=_bend_per_node(rig, s),
        k=rig.axial_stiffness / np.diff(s),
        c_in=rig.proximal_length_mm / rig.axial_stiffness,
        p=p,
        r=r,
        preload=rig.preload_N,
        delta=rig.presliding_length_mm,
    )
    mu = rig.friction_coefficient * _course(rig.friction_course, t) * _course(rig.bend_course, t)
    f_in, f_out, u_end, solved = continuum.run(tendon, x_in, mu, q)
    if solved < t.size:
        what = "the tendon is slack" if np.isfinite(f_in[solved]) else "the step fails"
        raise ValueError(f"{what} at {t[solved]:.6g} s")
    x_out = u_end - c_out * (f_out - rig.preload_N)
    return CleanRun(
        {"time_s": t, "x_in_mm": x_in, "x_out_mm": x_out, "f_in_N": f_in, "f_out_N": f_out}
    )


def _distal_end(
    rig: Rig, t: Floats, c_out: float, distal: Floats | None
) -> tuple[Floats, float, float]:
    """Return q, p, r of p T_out = q + r u_end, the free tendon at the load included."""
    F0, kL = rig.preload_N, rig.load_stiffness_N_per_mm
    if rig.load == "spring":
        return F0 * (_course(rig.preload_course, t) + kL * c_out), 1.0 + kL * c_out, kL
    distal = np.asarray(distal, dtype=float)
    if rig.load == "force":
        return distal, 1.0, 0.0
    if rig.load == "displacement":
        return c_out * F0 - distal, c_out, 1.0
    raise ValueError(f"load is {rig.load!r}, expected spring, force or displacement")


def _course(course: Course, t: Floats) -> Floats:
    at, value = np.array(course, dtype=float).T
    return np.asarray(np.interp(t, at, value))


def _bend_per_node(rig: Rig, s: Floats) -> Floats:
    """Return the bend angle between the midpoints around each node [rad]."""
    fine = np.linspace(0.0, rig.sheath_length_mm, 20001)
    curvature = _course(rig.bend_profile, fine / rig.sheath_length_mm)
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (curvature[1:] + curvature[:-1]))))
    edges = np.concatenate((s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]))
    return np.asarray(rig.total_bend_rad * np.diff(np.interp(edges, fine, angle / angle[-1])))
