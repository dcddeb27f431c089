"""The guide of the load has friction of the same force at any tension.

What one sees: after a reversal x_out stands still for longer. With friction behind the f_out
sensor, f_out over x_out is a loop of constant height, and f_out changes while x_out stands still.
With friction before it, f_out over x_out stays a line, and f_in over f_out is wider by a constant
that is larger on a pull than on a release.
Equation: Coulomb friction Fc independent of the tension. The sheath transmits it like the load:
f_in has Fc e^(μθ) of it on a pull, Fc e^(−μθ) on a release (Yang 2025, Eq. 7). The paper has no
friction at its load.
Mistaken for: drive_friction (the same in f_in on pull and release, without effect on x_out);
sheath_drag (between both in f_in, without effect on f_out over x_out);
load_hysteresis (its loop leans over a travel); load_damping (grows with the speed);
load_spring_nonlinearity (a curve, not a loop); load_dependent_friction (curves in f_in over f_out);
backlash (f_in is constant too).
Not validated: guides with a breakaway force above the sliding friction, or that tilt under the
load.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class LoadFriction(NamedTuple):
    """Friction on the load's and on the tendon's side of the f_out sensor [N]."""

    after_sensor_N: float = 0.0
    before_sensor_N: float = 0.0


@kernel
def guide_friction(load: LoadFriction) -> float:
    """Return the friction on both sides of the sensor together [N]."""
    return load.after_sensor_N + load.before_sensor_N


LOAD_FRICTION = Effect(
    name="load_friction",
    title="Friction at the load",
    acts_on="load",
    closed_form=False,
    equation="f_out = spring force + Fc_after·sgn(v_out),  TL = f_out + Fc_before·sgn(v_out)",
    doc=__doc__,
    parameters=(
        Parameter("after_sensor_N", "N", neutral=0.0, start=0.5, lower=0.0, upper=1000.0),
        Parameter("before_sensor_N", "N", neutral=0.0, start=0.5, lower=0.0, upper=1000.0),
    ),
    experiment="Remove the tendon and push the load back and forth by its f_out sensor: half the "
    "height of the loop is the friction.",
)
