"""Intervals of estimates, with what tolerances move."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import intervals
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Unknown
from tsas_cli.identification.quantities import QUANTITIES


@pytest.mark.parametrize(
    ("log_EA", "ratio", "stated"),
    [(-0.2, 0.2, (0.1, 1.2 * math.exp(0.3) - 1.0)), (0.3, 0.1, (0.3, 0.1))],
)
def test_a_sheath_is_stated_for_the_tendon_of_the_data_sheet(log_EA, ratio, stated):
    """(1 + ratio)/EA is what the recordings determine; a ratio is not negative."""
    names = ("free_tendon.distal_length_mm", intervals.TENDON, intervals.SHEATH)
    sheath = QUANTITIES[intervals.SHEATH]
    unknowns = [Unknown(name, None, 0.0, -0.3, 0.5, 1.0) for name in names]
    values = np.array([2.0, log_EA, sheath.scaled(ratio)])
    found = intervals._at_data_sheet(values, SimpleNamespace(unknowns=unknowns))
    assert (found[1], sheath.unscaled(found[2])) == pytest.approx(stated)
    assert found[0] == pytest.approx(2.0 * math.exp(stated[0] - log_EA))
    assert intervals._at_data_sheet(values, SimpleNamespace(unknowns=unknowns[:2])) is values


def test_a_sheath_is_as_unsure_as_the_tendons_data_sheet():
    """(1 + ratio)/EA is what is told: with EA 20 % up or down the ratio follows."""
    ratio = Estimate("sheath_compression.compliance_ratio", 0.5, "1", "fitted", None, 0.0, 0.5, 0.5)
    found = intervals._with_data_sheet_interval(ratio, (math.log(0.8), math.log(1.2)))
    assert found.interval_low == pytest.approx(1.5 * 0.8 - 1.0)
    assert found.interval_high == pytest.approx(1.5 * 1.2 - 1.0)
    assert found.stderr == pytest.approx(0.3 / 1.96)
    low = replace(ratio, value=0.1)
    assert intervals._with_data_sheet_interval(low, (math.log(0.8), 0.1)).interval_low == 0.0
