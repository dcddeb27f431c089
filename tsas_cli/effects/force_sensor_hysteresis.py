"""A force sensor reads less while the force grows than while it falls.

What one sees: f_out over x_out is a loop of constant height, run through against friction: the
reading is low on the pull and high on the release, and follows x_out at once. It closes over a
span of force, at any speed. In f_in the jump at reversals is smaller by as much.
Equation: the reading is the tension less a share of an elastoplastic element (Prandtl): its force z
follows the tension, dz = dT, as long as |z| is below the span. The loop is 2·share·span high; it is
one play operator of the Prandtl-Ishlinskii model of load cells. Not in the paper.
Mistaken for: load_friction, drive_friction (loops of the opposite sense: they add on a pull); a
smaller friction coefficient (its share grows with the tension); sensor_lag, channel_delay (grow
with the speed).
Not validated: the state of the element before a run, which is taken to be without force; creep. A
measured tension that drives the model is taken as it is, with its loop.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter, shape
from tsas_cli.numerics.compiled import kernel


class ForceSensorHysteresis(NamedTuple):
    """Share of the element in each force sensor's reading [1], and its span [N]."""

    f_in_share: float = 0.0
    f_out_share: float = 0.0
    span_N: float = 10.0


@kernel
def read_hysteresis(force: float, element_N: float, share: float) -> float:
    """Return the reading of a sensor [N] that holds back a share of an element's force."""
    return force - share * element_N


FORCE_SENSOR_HYSTERESIS = Effect(
    name="force_sensor_hysteresis",
    title="Hysteresis of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading = T − share·z,  dz = dT while |z| < span",
    doc=__doc__,
    parameters=(
        Parameter("f_in_share", "1", neutral=0.0, start=0.02, lower=0.0, upper=0.5),
        Parameter("f_out_share", "1", neutral=0.0, start=0.02, lower=0.0, upper=0.5),
        shape("span_N", "N", 10.0, lower=0.1, upper=1000.0, starts=(3.0, 10.0, 30.0)),
    ),
    experiment="Load the sensor by weights one by one and unload it the same way: half the gap "
    "between both readings at one weight is the share of the span.",
)
