"""How long a step of the dynamic chain is, and how far off it may be."""

import math

import pytest

from tests.physics.references import GROUP_A, LOADED_BY_SPRING
from tsas_cli.physics.lugre.ends import EndState, StepEnds
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.lugre.state import Formula, Given
from tsas_cli.physics.lugre.step import Tolerances, fit_to_reversal, step_factor, tolerances_of


@pytest.mark.parametrize(
    ("f_in", "f_out", "tension"),
    [(-80.0, 60.0, 80.0), (50.0, -90.0, 90.0), (1.0, 1.0, 0.1 * GROUP_A.preload_N)],
)
def test_what_a_step_may_be_off_by_is_a_share_of_the_largest_tension(f_in, f_out, tension):
    law = lugre_laws(GROUP_A, 3, LOADED_BY_SPRING)
    ends = StepEnds(*(EndState(Given(0.0, 0.0), 0.0, 0.0, f, 0.0) for f in (f_in, f_out)), 0.0)
    found = tolerances_of(ends, law, 1e-3, 1.0)
    assert found == pytest.approx((1e-3 * tension, 0.3e-3 * tension))
    assert tolerances_of(ends, law, 1e-3, 1e-5).residual_N == pytest.approx(1e-5 * tension)
    heavy = law._replace(load=law.load._replace(mass_kg=1.0))
    assert tolerances_of(ends, heavy, 1e-3, 1.0)[0] < found[0]
    assert tolerances_of(ends, law, math.inf, 1e-5).error_N == math.inf


FIRST = Formula(1.0, math.inf, math.inf, 1.0, 1.0, 0.0)
THIRD = FIRST._replace(h1=1.0, h2=1.0)


@pytest.mark.parametrize(
    ("off", "formula", "change"),
    [
        (1.0, FIRST, 0.85),  # as far off as it may be
        (1.0, THIRD, 0.85),
        (4.0, FIRST, 0.85 / 2.0),  # the root, and the cubic one where two steps are known
        (8.0, THIRD, 0.85 / 2.0),
        (100.0, FIRST, 0.25),
        (0.0, THIRD, 2.0),
        (math.inf, THIRD, 0.25),
    ],
)
def test_the_next_step_follows_from_the_error_of_this_one(off, formula, change):
    assert step_factor(off, Tolerances(1.0, 1.0), formula) == pytest.approx(change)


@pytest.mark.parametrize(
    ("h", "step", "lands"),
    [
        *((0.4, 0.4, False), (0.5, 0.5, False), (0.6, 0.5, False), (0.9999, 0.5, False)),
        *((1.0, 1.0, True), (1.0 - 1e-10, 1.0, True), (3.0, 1.0, True)),
    ],
)
def test_a_step_lands_on_a_turn_and_leaves_no_short_rest(h, step, lands):
    assert fit_to_reversal(h, 1.0) == (step, lands)
