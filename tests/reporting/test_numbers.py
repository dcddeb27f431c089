import math

import numpy as np
import pytest

from tsas_cli.records.tracking import Spread
from tsas_cli.reporting.numbers import ABSENT, plain, spanned, with_interval, with_spread


@pytest.mark.parametrize(
    ("value", "low", "high", "shown"),
    [
        (2.33812, 2.3262, 2.3501, ("2.338", "2.326 to 2.350")),
        (67858.4, 66624.0, 69093.0, ("67900", "66600 to 69100")),
        (-0.5, -0.53, -0.47, ("−0.500", "−0.530 to −0.470")),
        (12.0, 2.0, 22.0, ("12", "2 to 22")),
        (3.1e-9, 3.0e-9, 3.2e-9, ("3.10·10⁻⁹", "3.00·10⁻⁹ to 3.20·10⁻⁹")),
        (0.0538707, 0.0538637, 0.0538777, ("0.0538707", "0.0538637 to 0.0538777")),
        (0.0, -1.5, 1.5, ("0.0", "−1.5 to 1.5")),
        (-0.0001, -1.0, 1.0, ("0.0", "−1.0 to 1.0")),
        # A fit that gets stuck may leave no width to speak of.
        (2.5, 2.5 - 1e-15, 2.5 + 1e-15, ("2.500000000", "2.500000000 to 2.500000000")),
    ],
)
def test_value_and_interval_end_at_the_same_digit(value, low, high, shown):
    assert with_interval(value, low, high) == shown


def test_plain_numbers_have_significant_digits_and_what_is_not_known_is_a_dash():
    shown = {0.125: "0.1250", 1591.4: "1591", 67858.4: "67860", 0.0: "0.000", -2.0: "−2.000"}
    assert {value: plain(value) for value in shown} == shown
    for bad in (None, math.nan, math.inf):
        assert with_interval(1.579, 1.5, bad) == ("1.579", ABSENT)
        assert plain(bad) == ABSENT


@pytest.mark.parametrize(
    ("value", "spread", "shown"),
    [
        (0.867303, 0.000108, "0.8673 ± 0.0001"),
        (0.8673, 0.12, "0.9 ± 0.1"),
        (-2.087, 0.0003, "−2.087 ± 0.0003"),
        (1449.2, 5.6, "1449 ± 6"),
        (0.8673, None, "0.8673"),
        (0.0, 0.0, "0"),
        (None, None, ABSENT),
        (math.inf, 1.0, ABSENT),
        (0.8673, math.nan, "0.8673"),
    ],
)
def test_a_spread_stands_beside_its_value(value, spread, shown):
    assert with_spread(Spread(mean=value, sd=spread)) == shown


def test_a_span_leaves_gaps_out_and_says_where_there_is_nothing():
    assert spanned(np.array([np.nan, 2.0, -0.5])) == "−0.500 to 2.00"
    assert spanned(np.array([np.nan])) == ABSENT
