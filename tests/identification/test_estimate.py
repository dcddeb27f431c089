"""An estimate: what its interval holds."""

import pytest

from tsas_cli.identification.estimate import Estimate


@pytest.mark.parametrize(
    ("low", "high", "values", "held"),
    [
        (0.1, 0.3, (0.1, 0.3), True),
        (0.1, 0.3, (0.2, 0.31), False),
        (0.1, 0.3, (0.0,), False),
        (None, None, (0.2,), False),
    ],
)
def test_an_interval_holds_values_only_where_there_is_one(low, high, values, held):
    e = Estimate("friction", 0.2, "1", "fitted", interval_low=low, interval_high=high)
    assert e.holds(*values) == held
