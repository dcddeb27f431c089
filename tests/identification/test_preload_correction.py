"""By how much fitted preloads miss the stated ones, on numbers that are worked out by hand."""

import math
from types import SimpleNamespace

import pytest

from tsas_cli.identification.calibration import with_preload_correction
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import CORRECTION, Model

STUDENT = {1: 12.7062, 2: 4.30265}  # 97.5 %, as tables have it


def corrected(*pairs, stderr=0.1):
    """Return what runs with these fitted and stated preloads say of others."""
    runs = [
        SimpleNamespace(run=SimpleNamespace(id=f"r{k}", preload_N=stated))
        for k, (_, stated) in enumerate(pairs)
    ]
    told = tuple(
        Estimate("preload_N", fitted, "N", "fitted", f"r{k}", stderr)
        for k, (fitted, _) in enumerate(pairs)
        if fitted is not None
    )
    model = Model((Estimate("friction_coefficient", 0.1, "1", "fitted", None, 0.01), *told))
    return model, with_preload_correction(model, runs)


def test_two_runs_give_a_mean_and_how_far_a_third_may_lie_from_it():
    """Off by 1 and 3: a mean of 2, a scatter of √2, for one more run √2·√(1 + 1/2) = √3."""
    model, found = corrected((21.0, 20.0), (33.0, 30.0))
    e = found.estimate(CORRECTION)
    assert (e.value, e.unit, e.origin, e.run) == (2.0, "N", "fitted", None)
    assert e.stderr == pytest.approx(math.sqrt(3.0))
    assert e.interval_low == pytest.approx(2.0 - STUDENT[1] * math.sqrt(3.0), rel=1e-5)
    assert e.interval_high == pytest.approx(2.0 + STUDENT[1] * math.sqrt(3.0), rel=1e-5)
    assert set(model.estimates) == set(found.estimates) - {e}


def test_three_runs_have_two_degrees_of_freedom():
    """Off by −1, 1 and 6: a mean of 2, squares of 9 + 1 + 16, so √13 · √(4/3)."""
    _, found = corrected((19.0, 20.0), (31.0, 30.0), (46.0, 40.0))
    e = found.estimate(CORRECTION)
    assert e.value == pytest.approx(2.0)
    assert e.stderr == pytest.approx(math.sqrt(52.0 / 3.0))
    half = STUDENT[2] * math.sqrt(52.0 / 3.0)
    assert e.interval_high - e.value == pytest.approx(half, rel=1e-5)


def test_fewer_than_two_runs_give_none():
    for pairs in ([], [(21.0, 20.0)], [(21.0, 20.0), (33.0, None)], [(21.0, 20.0), (None, 30.0)]):
        model, found = corrected(*pairs)
        assert found is model
    model, found = corrected((21.0, 20.0), (33.0, 30.0), stderr=None)  # stated, not fitted
    assert found is model


def test_a_former_correction_is_replaced():
    _, once = corrected((21.0, 20.0), (33.0, 30.0))
    runs = [SimpleNamespace(run=SimpleNamespace(id=f"r{k}", preload_N=20.0)) for k in range(2)]
    again = with_preload_correction(once, runs)
    assert again.value(CORRECTION) == pytest.approx(7.0)  # 1 and 13
    assert sum(e.name == CORRECTION for e in again.estimates) == 1
