"""A lumped tendon as a model file of MuJoCo (MJCF)."""

from collections.abc import Sequence
from xml.sax.saxutils import quoteattr

from tsas_cli.physics.lumped import Lumped

STEP_S = 1e-4
LEAST_MASS_KG = 0.01  # of a point, which has to have one
LOAD_DAMPING_N_S_PER_M = 5.0  # where the model has none: else the load spring rings
_PER_M = 1e3  # of something per mm
_NO_PUSH_M = -1e3  # a length so short that the tendon never pushes
# Default friction constraints creep: these hold within a step or two.
_HOLDS = f'solreffriction="{2.0 * STEP_S:g} 1" solimpfriction="0.999 0.9999 0.001"'


def mjcf(name: str, lumped: Lumped, comments: Sequence[str], *, gear: float) -> str:
    """Return a model file of MuJoCo, in N, m, kg and s.

    `gear` is the tension at the drive [N] per unit of control. Joints drive, sheath and load are
    x_in, the tendon in the middle of the sheath, and x_out, 0 at the preload; each tendon's force
    is the tension, that of `proximal` f_in, of `distal` f_out.
    """
    drive = _joint(
        "drive",
        lumped.drive_friction_N,
        lumped.drive_damping_N_s_per_mm * _PER_M,
        f' stiffness="{lumped.beside_N_per_mm * _PER_M:.9g}"' if lumped.beside_N_per_mm else "",
    )
    sheath = _joint("sheath", lumped.sheath_friction_N, lumped.sheath_damping_N_s_per_mm * _PER_M)
    load = _joint(
        "load",
        lumped.load_friction_N,
        lumped.load_damping_N_s_per_mm * _PER_M or LOAD_DAMPING_N_S_PER_M,
        f' stiffness="{lumped.load_N_per_mm * _PER_M:.9g}"'
        f' springref="{-lumped.preload_N / lumped.load_N_per_mm / _PER_M:.9g}"',
    )
    said = "\n".join(f"  {line.replace('--', '- -')}" for line in comments)
    return f"""<mujoco model={quoteattr(name)}>
  <!--
{said}
  -->
  <option timestep="{STEP_S:g}" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    {_body("drive", 0.0, drive, lumped.drive_mass_kg)}
    {_body("sheath", 0.1, sheath, 0.0)}
    {_body("load", 0.2, load, lumped.load_mass_kg)}
  </worldbody>
  <tendon>
    {_tendon("proximal", "drive", "sheath", lumped.proximal_N_per_mm, lumped.preload_N)}
    {_tendon("distal", "sheath", "load", lumped.distal_N_per_mm, lumped.preload_N)}
  </tendon>
  <actuator>
    <motor name="drive" joint="drive" gear="{gear:.9g}"/>
  </actuator>
</mujoco>
"""


def _joint(name: str, friction_N: float, damping_N_s_per_m: float, more: str = "") -> str:
    friction = f' frictionloss="{friction_N:.9g}" {_HOLDS}' if friction_N else ""
    damping = f' damping="{damping_N_s_per_m:.9g}"' if damping_N_s_per_m else ""
    return f'<joint name="{name}" type="slide" axis="1 0 0"{friction}{damping}{more}/>'


def _body(name: str, x_m: float, joint: str, mass_kg: float) -> str:
    mass = max(mass_kg, LEAST_MASS_KG)
    geom = f'<geom type="sphere" size="0.005" mass="{mass:.9g}" contype="0" conaffinity="0"/>'
    return f'<body name="{name}" pos="{x_m:g} 0 0">{joint}{geom}</body>'


def _tendon(name: str, near: str, far: str, stiffness_N_per_mm: float, preload_N: float) -> str:
    rest_m = -preload_N / stiffness_N_per_mm / _PER_M
    return (
        f'<fixed name="{name}" stiffness="{stiffness_N_per_mm * _PER_M:.9g}" '
        f'springlength="{_NO_PUSH_M:g} {rest_m:.9g}">'
        f'<joint joint="{near}" coef="1"/><joint joint="{far}" coef="-1"/></fixed>'
    )
