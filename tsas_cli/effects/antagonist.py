"""A second tendon in its own sheath pulls the load back, over the same pulleys at drive and load.

What one sees: f_in, if it is the torque of the drive, has a wider loop at the same f_out: both
tendons rub, and the more the higher both are stretched; dead bands are up to twice as stiff. Where
the load pulls so hard that the second tendon goes slack the rest is as with one tendon: a kink in
each stroke. If f_in is a load cell in the first tendon it reads the second one's tension on top.
Equation: Agrawal, Peine and Yao 2010 (IEEE Trans. Robotics 26(5), 914-924), for two cables in
conduits in a pull-pull arrangement: each obeys Yang 2025, Eqs. (2) and (3), the second one with
displacements −x_in at the drive and −x_out at the load; it is slack where these leave it longer
than without tension. T1 − T2 = f_out at the load. At rest T2 is its preload and T1 that and F0.
Mistaken for: drive_friction (the same force at every tension, not passed on to x_out);
load_dependent_friction (does not end with a kink); load_hysteresis and load_friction (are in f_out
over x_out); force_sensor_offset (what a load cell in the first tendon adds, but for its loop).
Not validated: pulleys of different radii at drive and load, or of the two tendons; a load cell in
one tendon at the load; both tendons in one sheath; the dynamic model and closed loops, which refuse
it.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter, shape
from tsas_cli.numerics.compiled import kernel


class Antagonist(NamedTuple):
    """Tension of the second tendon at rest [N], its friction over the first one's [1].

    And the share of its tension at the drive that f_in subtracts [1].
    """

    preload_N: float = 0.0
    friction_ratio: float = 1.0
    f_in_share: float = 1.0


@kernel
def is_taut(longer_mm: float, compliance_mm_per_N: float, preload_N: float) -> bool:
    """Return whether a tendon, longer than at its preload by a length, has tension."""
    return longer_mm > -compliance_mm_per_N * preload_N


@kernel
def net_force(first_N: float, second_N: float, share: float) -> float:
    """Return the force at a sensor that subtracts a share of the second tendon's tension [N]."""
    return first_N - share * second_N


ANTAGONIST = Effect(
    name="antagonist",
    title="Antagonistic tendon",
    acts_on="tendon",
    closed_form=False,
    equation="f_out = T1(L) − T2(L),  f_in = T1(0) − share·T2(0),  x2 = −x1 at both ends,  "
    "μ2 = ratio·μ",
    doc=__doc__,
    parameters=(
        Parameter("preload_N", "N", neutral=0.0, start=20.0, lower=0.0, upper=1e4),
        shape("friction_ratio", "1", 1.0, lower=0.05, upper=20.0),
        shape("f_in_share", "1", 1.0, lower=-0.5, upper=1.5, starts=(1.0, 0.0)),
    ),
    experiment="Take the second tendon off its pulleys and repeat the run: the loop of f_in over "
    "f_out becomes narrower, and the kink in each stroke disappears.",
)
