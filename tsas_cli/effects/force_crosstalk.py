"""A force sensor picks up a share of the other sensor's force.

What one sees: of f_out, that it moves in dead bands, where the load stands still, by a share of the
change of f_in. Of f_in, that both of its lines over f_out are too steep by the same amount, while
the dead bands fit.
Equation: the reading is the tension plus a share of that at the other end, as with sensors on one
plate, on one supply or in one cable. Not in the paper.
Mistaken for: direction_dependent_friction, force_sensor_gain (in full slip exactly the same within
one bend as a share of f_out in f_in: only the dead bands separate them); force_sensor_offset (the
same force at every tension); load_friction (f_out moves in dead bands too, but by no more than
twice the friction).
Not validated: crosstalk of torques and side forces. A measured tension that drives the model is
taken as it is, with what it holds of the other one.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


class ForceCrosstalk(NamedTuple):
    """Share of f_out in the reading of f_in, and of f_in in that of f_out [1]."""

    f_in_of_f_out: float = 0.0
    f_out_of_f_in: float = 0.0


@kernel
def with_crosstalk(force: Values, other: Values, share: float) -> Values:
    """Return the reading of a sensor that picks up a share of another force [N]."""
    return force + share * other


FORCE_CROSSTALK = Effect(
    name="force_crosstalk",
    title="Crosstalk between the force sensors",
    acts_on="sensor",
    closed_form=True,
    equation="reading of f_in = T0 + share·TL,  reading of f_out = TL + share·T0",
    doc=__doc__,
    parameters=(
        Parameter("f_in_of_f_out", "1", neutral=0.0, start=0.01, lower=-0.5, upper=0.5),
        Parameter("f_out_of_f_in", "1", neutral=0.0, start=0.01, lower=-0.5, upper=0.5),
    ),
    experiment="Hang a weight on each force sensor alone: the other one must not move.",
)
