"""The LuGre chain as an ordinary differential equation, apart from the product's own.

n lumps with LuGre friction between springs and dampers; half segments at both ends, and at the
load end a point without mass. The state holds y = x − x_in [mm], w = v − v_in [mm/s] and the
bristles' deflection z [mm] of each lump in turn, then y of the load end. Relative to the drive
solvers take about a quarter of the steps. Units are mm, N, s and tonne.
"""

import math
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np

from benchmarks.lugre_rivals.drives import Floats, Sine, Sines, Tables

LITERAL_BRISTLE_DAMPING_N_S_PER_MM = 50 * 0.31622


class Constants(NamedTuple):
    """What the equations of one lump and one segment hold; `cvode.c` has the same order."""

    mass_t: float
    stiffness_N_per_mm: float
    damping_N_s_per_mm: float
    load_stiffness_N_per_mm: float
    preload_N: float
    bristle_stiffness_N_per_mm: float
    bristle_damping_N_s_per_mm: float
    viscous_N_s_per_mm: float
    friction_per_tension: float
    stribeck_excess: float
    stribeck_speed_mm_s: float


@dataclass(frozen=True)
class Model:
    """Tendon, sheath, load and bristles; those of the whole length, n lumps share them."""

    lumps: int = 50
    bend_radius_mm: float = 250.0
    total_bend_rad: float = math.pi
    tendon_stiffness_N: float = 60e3 * math.pi / 4.0 * 1.2**2
    load_stiffness_N_per_mm: float = 1.579
    preload_N: float = 25.0
    density_t_per_mm: float = 2.5e-9
    damping_per_lump_N_s_per_mm: float = 0.1 / 50
    bristle_stiffness_N_per_mm: float = 5000.0
    bristle_damping: Literal["critical", "literal"] | float = "critical"  # [N s/mm]
    viscous_N_s_per_mm: float = 0.02
    friction_coefficient: float = 0.125
    stribeck_excess: float = 0.04
    stribeck_speed_mm_s: float = 0.01

    @property
    def whole_bristle_damping(self) -> float:
        """σ1 [N s/mm]: critical for the mass on its bristles, the published value, or any other."""
        if isinstance(self.bristle_damping, float):
            return self.bristle_damping
        if self.bristle_damping == "literal":
            return LITERAL_BRISTLE_DAMPING_N_S_PER_MM
        return 2.0 * math.sqrt(self.bristle_stiffness_N_per_mm * self.mass_t)

    @property
    def mass_t(self) -> float:
        """Mass of the whole tendon."""
        return self.density_t_per_mm * self.length_mm

    @property
    def length_mm(self) -> float:
        """Length of the sheath."""
        return self.bend_radius_mm * self.total_bend_rad

    def constants(self) -> Constants:
        """Return the shares of one lump and one segment."""
        n = self.lumps
        return Constants(
            mass_t=self.mass_t / n,
            stiffness_N_per_mm=self.tendon_stiffness_N * n / self.length_mm,
            damping_N_s_per_mm=self.damping_per_lump_N_s_per_mm * n,
            load_stiffness_N_per_mm=self.load_stiffness_N_per_mm,
            preload_N=self.preload_N,
            bristle_stiffness_N_per_mm=self.bristle_stiffness_N_per_mm / n,
            bristle_damping_N_s_per_mm=self.whole_bristle_damping / n,
            viscous_N_s_per_mm=self.viscous_N_s_per_mm / n,
            friction_per_tension=math.tanh(self.friction_coefficient * self.total_bend_rad / 2 / n),
            stribeck_excess=self.stribeck_excess,
            stribeck_speed_mm_s=self.stribeck_speed_mm_s,
        )

    def record(self) -> dict[str, Any]:
        """Return the parameters, and what follows from them for the bristles."""
        return asdict(self) | {"bristle_damping_N_s_per_mm": self.whole_bristle_damping}


class Drive(Protocol):
    """How the drive moves, from rest at zero."""

    def position(self, time_s: Floats) -> Floats:
        """Return x_in [mm]."""

    def motion(self, time_s: float) -> tuple[float, float, float]:
        """Return x_in [mm], v_in [mm/s] and a_in [mm/s²]."""

    def tables(self) -> Tables:
        """Return the same for compiled code."""

    def record(self) -> dict[str, Any]:
        """Return the parameters."""


@dataclass(frozen=True)
class Problem:
    """A model, how it is driven, and when its forces are wanted [s]; the first time is zero."""

    model: Model
    drive: Drive
    time_s: Floats

    def start(self) -> Floats:
        """Return the state at rest with the same tension all along."""
        state = np.zeros(3 * self.model.lumps + 1)
        state[1:-1:3] = -self.drive.motion(0.0)[1]
        return state


class Output(NamedTuple):
    """What is seen at both ends."""

    f_in_N: Floats
    f_out_N: Floats
    x_out_mm: Floats


def output(problem: Problem, y: Floats, w: Floats, y_load: Floats) -> Output:
    """Return the forces and the load's displacement, given the first lump and the load end."""
    p = problem.model.constants()
    x_out = y_load + problem.drive.position(problem.time_s)
    f_in = p.preload_N - 2.0 * (p.stiffness_N_per_mm * y + p.damping_N_s_per_mm * w)
    return Output(f_in, p.preload_N + p.load_stiffness_N_per_mm * x_out, x_out)


def rate(t_s: float, state: Floats, problem: Problem) -> Floats:
    """Return the state's rate of change: the equations as one reads them, in numpy.

    m dv_i/dt = T_i − T_{i+1} − f_i,  f_i = σ0 z_i + σ1 dz_i/dt + σ2 v_i
    dz_i/dt = v_i − σ0 |v_i| z_i / g_i
    g_i = |T_i + T_{i+1}| tanh(μ θ/(2 n)) (1 + e exp(−(v_i/vs)²))
    """
    p = problem.model.constants()
    x_in, v_in, a_in = problem.drive.motion(t_s)
    y, w, z, y_load = state[:-1:3], state[1:-1:3], state[2:-1:3], state[-1]
    x, v, x_load = x_in + y, v_in + w, x_in + y_load

    k, c = p.stiffness_N_per_mm, p.damping_N_s_per_mm
    load = p.load_stiffness_N_per_mm * x_load
    v_load = v[-1] + (2.0 * k * (x[-1] - x_load) - load) / (2.0 * c)
    stretch = -np.diff(x, prepend=x_in, append=x_load)
    stretching = -np.diff(v, prepend=v_in, append=v_load)
    half = np.ones(x.size + 1)
    half[[0, -1]] = 2.0
    T = p.preload_N + half * (k * stretch + c * stretching)

    stribeck = 1.0 + p.stribeck_excess * np.exp(-((v / p.stribeck_speed_mm_s) ** 2))
    g = np.abs(T[:-1] + T[1:]) * p.friction_per_tension * stribeck
    dz = v - np.abs(v) * z * p.bristle_stiffness_N_per_mm / g
    f = (
        p.bristle_stiffness_N_per_mm * z
        + p.bristle_damping_N_s_per_mm * dz
        + p.viscous_N_s_per_mm * v
    )
    out = np.empty_like(state)
    out[:-1:3], out[1:-1:3], out[2:-1:3] = w, (T[:-1] - T[1:] - f) / p.mass_t - a_in, dz
    out[-1] = v_load - v_in
    return out


def group(name: str, *, lumps: int = 50) -> tuple[Model, Sines]:
    """Return the rig and the drive of a group of Table 2 of Yang 2025."""
    omega_rad_s, radius_mm, bend_rad = {
        "a": (1.0, 250.0, math.pi),
        "b": (2.0, 250.0, math.pi),
        "c": (1.0, 200.0, math.pi),
        "d": (1.0, 200.0, math.pi / 2.0),
    }[name]
    model = replace(Model(), lumps=lumps, bend_radius_mm=radius_mm, total_bend_rad=bend_rad)
    return model, Sines((Sine(10.0, omega_rad_s),))
