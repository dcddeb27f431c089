"""What is said of each parameter fits its name, its sign and every rig that one may meet."""

import math

import pytest

from tests.physics.references import TABLE_1
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.parameters import BRISTLES, NOMINAL, NOMINAL_BY_NAME
from tsas_cli.physics.rig import Rig

EVERY = [*NOMINAL, *BRISTLES]
ZEROS = ("x_in_zero_mm", "x_out_zero_mm")
NO_UNIT_IN_ITS_NAME = {"friction_coefficient": "1"}
BY_ENDING = {  # the longest that fits
    "_N_per_mm": "N/mm",
    "_N_s_per_mm": "N s/mm",
    "_kg_per_m": "kg/m",
    "_N": "N",
    "_mm": "mm",
}


def test_names_are_those_of_rig_and_bristles():
    assert {p.name for p in NOMINAL} < set(Rig._fields)
    assert [p.name for p in BRISTLES] == list(Bristles._fields)
    assert list(NOMINAL_BY_NAME) == [p.name for p in NOMINAL]
    assert all(NOMINAL_BY_NAME[p.name] is p for p in NOMINAL)


@pytest.mark.parametrize("parameter", EVERY, ids=[p.name for p in EVERY])
def test_one_parameter(parameter):
    """Bounds are powers of ten, about zero alike where either sign may be."""
    ending = next((e for e in BY_ENDING if parameter.name.endswith(e)), None)
    unit = BY_ENDING[ending] if ending else NO_UNIT_IN_ITS_NAME[parameter.name]
    assert parameter.unit == unit
    assert parameter.positive == (parameter.name not in ZEROS)
    assert parameter.positive == (parameter.lower > 0.0)
    if not parameter.positive:
        assert parameter.lower == -parameter.upper
    for bound in (abs(parameter.lower), parameter.upper):
        power = math.log10(bound)
        assert power == pytest.approx(round(power), abs=1e-12)
    # Each run has been set up anew: it has a preload and zeros of its own.
    assert parameter.shared == (parameter.name not in ("preload_N", *ZEROS))


def test_the_rig_of_the_paper_is_far_from_all_bounds():
    for parameter in EVERY:
        source = TABLE_1 if parameter in NOMINAL else TABLE_1.bristles
        value = getattr(source, parameter.name)
        if parameter.positive and not math.isnan(value):
            assert 10.0 * parameter.lower < value < 0.1 * parameter.upper, parameter.name
