"""A motion is lost at the load, by a law of unnamed origin.

What one sees: a residual of x_out that repeats with the displacement of the load: with its place,
with the travel since its reversals, with the tension; the forces have none of it.
Equation: x_out = x − Σ lost_k·s_k(x) + curve(x) − compliance·f_out, x the displacement of the
tendon's end, s_k the stop operator of width travel·4^(1−k). The paper has none.
Mistaken for: a cause. A law describes what no proven cause explains: play, a soft joint, an encoder
that slips, and whatever else is between the tendon's end and the reading of x_out.
Not validated: displacements, tensions and speeds beyond those that it was fitted to; what the lost
motion does to the forces.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.stops import ELEMENTS, curve_of, states_of, widths_of
from tsas_cli.support.arrays import Floats


class LoadLaw(NamedTuple):
    """Longest width, range of the curve; weights of the elements; heights of the curve."""

    travel_mm: float = 1.0
    low_mm: float = 0.0
    high_mm: float = 1.0
    lost_1_mm: float = 0.0
    lost_2_mm: float = 0.0
    lost_3_mm: float = 0.0
    lost_4_mm: float = 0.0
    lost_5_mm: float = 0.0
    lost_6_mm: float = 0.0
    curve_2_mm: float = 0.0
    curve_3_mm: float = 0.0
    curve_4_mm: float = 0.0
    curve_5_mm: float = 0.0
    compliance_mm_per_N: float = 0.0


FIRST = 3  # of the weights


def load_law_motion(law: LoadLaw, x: Floats, f_out: Floats, memory: Floats) -> Floats:
    """Return by how much the reading exceeds the displacement of the tendon's end [mm].

    From arrays of shape (n,); `memory` is that of the elements, updated in place.
    """
    states = states_of(x, widths_of(law.travel_mm), memory)
    curve = curve_of(x, law.low_mm, law.high_mm, (0.0, *law[FIRST + ELEMENTS : -1]))
    lost: Floats = law[FIRST : FIRST + ELEMENTS] @ states + law.compliance_mm_per_N * f_out
    return curve - lost


LOAD_LAW = Effect(
    name="load_law",
    title="Lost motion at the load, of unnamed origin",
    acts_on="load",
    closed_form=True,
    equation="x_out = x − Σ lost_k·s_k(x) + curve(x) − compliance·f_out",
    doc=__doc__,
    parameters=(
        Parameter("travel_mm", "mm", 1.0, 1.0, 1e-6, 1e4, given=True),
        Parameter("low_mm", "mm", 0.0, 0.0, -1e5, 1e5, given=True),
        Parameter("high_mm", "mm", 1.0, 1.0, -1e5, 1e5, given=True),
        *(Parameter(f"lost_{k}_mm", "mm", 0.0, 0.1, 0.0, 1e4) for k in range(1, 7)),
        *(Parameter(f"curve_{k}_mm", "mm", 0.0, 0.1, -1e4, 1e4) for k in range(2, 6)),
        Parameter("compliance_mm_per_N", "mm/N", 0.0, 0.01, 0.0, 1e3, of_forces=True),
    ),
    experiment="Measure the displacement of the tendon's end beside x_out, at several forces.",
)
