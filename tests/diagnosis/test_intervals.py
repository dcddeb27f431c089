"""Intervals that allow for the tolerances of a rig, and for the data sheet of its tendon."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import intervals
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted, Unknown
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


def test_tolerances_and_the_noise_add_up_in_squares(monkeypatch):
    """Noise leaves each of two unknowns by 1, a tolerance both together by 3, moved by 2 and −9."""
    given = {}
    fitted = Fitted(*(np.full(2, v) for v in (7.0, 1.0, 2.0)), np.zeros(2, bool), True, "", 1)

    def with_errors(unknowns, solution, blocks, *, by_run):
        given.update(blocks=[b.tolist() for b in blocks], by_run=by_run)
        return fitted

    def estimates_of(unknowns, fit, ids):
        ends = zip(fit.values, 2.0 * fit.stderr, strict=True)
        return [Estimate("a", v, "1", "fitted", None, w / 2.0, v - w, v + w) for v, w in ends]

    monkeypatch.setattr(intervals, "with_errors", with_errors)
    moves = np.array([2.0, -9.0]), np.full((2, 2), 9.0)
    monkeypatch.setattr(intervals, "moved_by_tolerances", lambda *_: moves)
    monkeypatch.setattr(intervals, "estimates_of", estimates_of)
    folds = Folds(np.zeros(6, int), np.array([0, 0, 1, 2, 2, 4]), np.repeat([0, 1], 3), True)
    bench = SimpleNamespace(rigs=[0, 1], base=SimpleNamespace(problem=SimpleNamespace(ids=[])))
    trial = SimpleNamespace(unknowns=[], solution=None, effects=(), correlation=lambda: np.eye(2))
    search = SimpleNamespace(folds=folds, bench=bench)
    found = intervals.estimates_with_tolerances(search, trial, np.zeros((6, 7)))
    half = np.hypot(2.0 * 1.0, 1.96 * 3.0)  # Student's t is of the noise alone
    assert [e.value for e in found.estimates] == [7.0, 7.0]
    assert [e.value for e in found.moved] == [9.0, -2.0]
    assert [e.stderr for e in found.estimates] == pytest.approx([half / 2.0] * 2)
    lows, highs = zip(*((e.interval_low, e.interval_high) for e in found.estimates), strict=True)
    assert lows == pytest.approx((9.0 - half, -2.0 - half))
    assert highs == pytest.approx((9.0 + half, 7.0))  # the value is held
    assert found.correlation == pytest.approx(np.array([[1.0, 0.9], [0.9, 1.0]]))
    assert given == {"blocks": [[0, 0, 1], [0, 0, 1]], "by_run": True}
