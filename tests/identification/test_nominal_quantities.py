"""What is said of each parameter fits its name, its sign and every rig that one may meet."""

import math

import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification.quantities import BRISTLES, NOMINAL
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.rig import Rig

EVERY = [*NOMINAL, *BRISTLES]
ZEROS = ("x_in_zero_mm", "x_out_zero_mm")
UNITS = {  # by the end of the name, the longest that fits
    "_N_per_mm": "N/mm",
    "_N_s_per_mm": "N s/mm",
    "_kg_per_m": "kg/m",
    "_N": "N",
    "_mm": "mm",
    "friction_coefficient": "1",
}


def test_names_are_those_of_rig_and_bristles():
    assert {p.name for p in NOMINAL} < set(Rig._fields)
    assert [p.name for p in BRISTLES] == [f"bristles.{name}" for name in Bristles._fields]


@pytest.mark.parametrize("parameter", EVERY, ids=[p.name for p in EVERY])
def test_one_parameter(parameter):
    """Each run has been set up anew: it has a preload and zeros of its own, of either sign."""
    name = parameter.name
    assert parameter.unit == next(UNITS[end] for end in UNITS if name.endswith(end))
    assert parameter.positive == (parameter.lower > 0.0) == (name not in ZEROS)
    assert parameter.positive or parameter.lower == -parameter.upper
    assert parameter.shared == (name not in ("preload_N", *ZEROS))


def test_the_rig_of_the_paper_is_far_from_all_bounds():
    for parameter in EVERY:
        source = TABLE_1 if parameter in NOMINAL else TABLE_1.bristles
        value = getattr(source, parameter.name.removeprefix("bristles."))
        if parameter.positive and not math.isnan(value):
            assert 10.0 * parameter.lower < value < 0.1 * parameter.upper, parameter.name
