"""The tendon passes a pulley or the mouth of the sheath, whose friction grows with the tension.

What one sees: at the drive, f_in jumps at every reversal, up when a pull begins and down when a
release begins, by more at high tension than at low, and then passes its dead band as before: in
full slip the loop of f_in over f_out is wider by the same share everywhere, as by more friction in
the sheath, but the step is immediate. At the load the step of f_out comes at the end of each dead
band.
Equation: the capstan law of Yang 2025, Eq. (7), at a point: the tensions of both sides have the
ratio e^loss. A bearing with friction μb, radius rb and wrap α on a pulley of radius r has
loss = 2 μb (rb/r) sin(α/2), an edge with the wrap α has loss = μ α. The paper's pulleys have none.
In the chain of n nodes it acts at the first or the last, half a segment (L/2n) inside the sheath.
Mistaken for: a larger friction coefficient, with uneven_friction (both together have the same sum,
over longer dead bands); drive_friction, load_friction (the same force at any tension);
a bend of the sheath at its end (the same thing).
Not validated: a pulley between the f_out sensor and the load.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter


class PulleyFriction(NamedTuple):
    """Logarithms of the ratios of tensions over the pulleys of drive and load, in slip [1]."""

    drive_loss: float = 0.0
    load_loss: float = 0.0


PULLEY_FRICTION = Effect(
    name="pulley_friction",
    title="Friction of a pulley at an end of the sheath",
    acts_on="tendon",
    closed_form=False,
    equation="T behind the pulley = T before it · e^(−loss · sgn(v))",
    doc=__doc__,
    parameters=(
        Parameter("drive_loss", "1", neutral=0.0, start=0.03, lower=0.0, upper=2.0),
        Parameter("load_loss", "1", neutral=0.0, start=0.03, lower=0.0, upper=2.0),
    ),
    experiment="Take the tendon out of the sheath, hang a weight on it over the pulley and pull "
    "back and forth: half the step of f_in over the weight is the loss.",
)
