"""The errors of each channel on held-out data, on runs whose errors are known."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import channel_errors as c
from tsas_cli.diagnosis.channel_errors import channel_errors
from tsas_cli.diagnosis.remainder import Remainder


class Simulated:
    """A run whose errors are known: each value of the trial adds to them."""

    def __init__(self, samples):
        self.weights = {"f_in_N": np.array([9.0, 0.3, 0.4]), "x_out_mm": np.array([0.5, 9.0, 9.0])}
        self.samples = {name: np.array(at) for name, at in samples.items()}

    def raw(self, rig):
        return {name: np.full(2, float(rig)) for name in self.samples}

    def spread(self, name, here):
        return here[:2]


@pytest.fixture
def errors(monkeypatch):
    monkeypatch.setattr(c, "held_out_values", lambda trial, folds, fold: (trial.off, fold))
    monkeypatch.setattr(c, "rig_at", lambda rig, k, unknowns, values: rig + values[0] * values[1])
    runs = [Simulated({"f_in_N": [1, 2]}), Simulated({"f_in_N": [1, 2], "x_out_mm": [0]})]
    bench = SimpleNamespace(
        channels=["f_in_N", "x_out_mm"],
        closed=runs,
        rigs=[1.0, 2.0],
        errors_for=lambda trial: runs,
    )
    folds = SimpleNamespace(fold=np.array([0, 1, 2, 3]), run=np.array([0, 0, 1, 1]))
    search = SimpleNamespace(bench=bench, folds=folds)

    def found(before, after, start, left):
        trials = [SimpleNamespace(off=v, unknowns=[]) for v in (before, after)]
        rest = [
            Remainder(1.0, dict(zip(bench.channels, v, strict=True)), ()) for v in (start, left)
        ]
        return channel_errors(search, *trials, *rest)

    return found


def test_errors_of_a_channel_are_root_mean_squares_over_what_was_held_out(errors):
    """Run 1 errs by 1 + off·fold in folds 0 and 1, run 2 by 2 + off·fold in 2 and 3."""
    found = errors(10.0, 1.0, (0.0, 0.0), (0.0, 0.0))
    mean = (1.0**2 + 11.0**2 + 22.0**2 + 32.0**2) / 4.0
    assert found["f_in_N"].rmse_before == pytest.approx(math.sqrt(mean))
    assert found["f_in_N"].rmse_after == pytest.approx(math.sqrt((1.0 + 4.0 + 16.0 + 25.0) / 4.0))
    assert found["x_out_mm"].rmse_after == pytest.approx(math.sqrt((16.0 + 25.0) / 2.0))


def test_noise_is_the_root_mean_square_of_what_the_samples_weigh(errors):
    found = errors(10.0, 1.0, (0.0, 0.0), (0.0, 0.0))
    assert found["f_in_N"].noise_floor == pytest.approx(math.sqrt((0.3**2 + 0.4**2) / 2.0))
    assert found["x_out_mm"].noise_floor == 0.5


def test_what_could_be_had_is_the_better_of_both_less_what_is_explained(errors):
    """Explained is in squares of the noise: 0.125 N² of f_in, 0.25 mm² of x_out."""
    after = {"f_in_N": 46.0 / 4.0, "x_out_mm": 41.0 / 2.0}
    found = errors(10.0, 1.0, (0.0, 0.0), (80.0, 1000.0))
    could = found["f_in_N"].attainable
    assert could == pytest.approx(math.sqrt(after["f_in_N"] - 80.0 * 0.125))
    assert found["x_out_mm"].attainable == 0.5  # no less than the noise
    before = (1.0**2 + 11.0**2 + 22.0**2 + 32.0**2) / 4.0
    first = errors(10.0, 1.0, (before / 0.125 - 16.0, 0.0), (0.0, 0.0))["f_in_N"]
    assert first.attainable == pytest.approx(math.sqrt(16.0 * 0.125))
    none = errors(10.0, 1.0, (1e9, 0.0), (0.0, 0.0))["f_in_N"]
    assert none.attainable == none.noise_floor


def test_what_was_reached_is_never_below_the_floor(errors):
    """An error of 0.1 N everywhere, where the noise is larger."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(c, "rig_at", lambda rig, k, unknowns, values: 0.1)
        found = errors(0.0, 0.0, (0.0, 0.0), (0.0, 0.0))["f_in_N"]
    assert found.rmse_after == pytest.approx(0.1)
    assert found.noise_floor == pytest.approx(0.1)
    assert found.attainable == pytest.approx(0.1)
