"""Held-out errors by new fits, against scipy's fit without each run, of a nonlinear model."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import least_squares

from tsas_cli.diagnosis import refitted as module
from tsas_cli.diagnosis.held_out import folds_of, held_out_values
from tsas_cli.diagnosis.refitted import (
    HeldOutFit,
    gain_anywhere,
    raw_gain,
    raw_squares,
    refitted,
    refitted_values,
)
from tsas_cli.identification.fit import Unknown, solve
from tsas_cli.identification.hypothesis_fit import HypothesisFit

RUNS, ROWS, NOISE = 4, 120, 0.05
T = np.linspace(0.0, 3.0, ROWS)


def curve(rate, offset, k):
    """Return an exponential whose rate is shared; each run begins elsewhere."""
    return np.exp(-np.exp(rate) * (T + 0.5 * k)) * 4.0 + offset


class Run:
    """A run of the exponential, in units of its noise."""

    def __init__(self, k, data):
        self.k, self.data = k, data

    def residuals(self, rig):
        return self.raw(rig)["f_in_N"] / NOISE

    def raw(self, rig):
        return {"f_in_N": self.data - curve(rig["rate"], rig["offset"], self.k)}

    def spread(self, name, chosen):
        return chosen

    def over_noise(self, name, errors, chosen):
        return errors[chosen] / NOISE


@pytest.fixture(scope="module")
def fitted():
    """Four runs, of which the last follows another rate: far from the fit to the others."""
    rng = np.random.default_rng(5)
    rates = [-0.5, -0.5, -0.5, 0.6]
    runs = [
        Run(k, curve(rate, 0.3 * k, k) + NOISE * rng.standard_normal(ROWS))
        for k, rate in enumerate(rates)
    ]
    unknowns = (
        Unknown("rate", None, 0.0, -5.0, 5.0, 1e3),
        *(Unknown("offset", k, 0.0, -9.0, 9.0, 1e3) for k in range(RUNS)),
    )
    rig_at = lambda rig, k, names, values: {"rate": values[0], "offset": values[1 + k]}  # noqa: E731
    bench = SimpleNamespace(
        rigs=[None] * RUNS,
        channels=["f_in_N"],
        errors_for=lambda trial: runs,
        tolerance_at=lambda mean_square: 1e-5,
    )
    found = solve(
        unknowns, RUNS, lambda k, v: runs[k].residuals(rig_at(None, k, (), v)), tolerance=1e-10
    )
    trial = HypothesisFit((), unknowns, found, (ROWS,) * RUNS, on_mesh=False)
    folds = folds_of([np.arange(ROWS) * 4 // ROWS for _ in range(RUNS)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "rig_at", rig_at)
        yield runs, bench, trial, folds


def without(runs, k):
    """Return scipy's rate of the other runs, and the offset of run k with it."""
    others = [run for run in runs if run.k != k]

    def errors(v):
        return np.concatenate([o.data - curve(v[0], v[1 + j], o.k) for j, o in enumerate(others)])

    rate = least_squares(errors, np.zeros(RUNS), xtol=1e-12, ftol=1e-12).x[0]
    return rate, float(np.mean(runs[k].data - curve(rate, 0.0, k)))


@pytest.mark.parametrize("k", range(RUNS))
def test_a_run_is_left_out_of_the_fit_and_its_offset_fitted_to_it(fitted, k):
    runs, bench, trial, folds = fitted
    rate, offset = without(runs, k)
    values = refitted_values(bench, trial, folds, k)
    assert (values[0], values[1 + k]) == pytest.approx((rate, offset), abs=1e-3)


def test_one_step_is_far_off_where_a_run_differs(fitted):
    """The reason for the new fit: the run whose rate differs draws the step to all runs."""
    runs, _, trial, folds = fitted
    rate, _ = without(runs, 3)
    assert abs(held_out_values(trial, folds, 3)[0] - rate) > 0.02


def test_errors_are_those_of_each_run_predicted_by_the_others(fitted):
    runs, bench, trial, folds = fitted
    errors = []
    for k, run in enumerate(runs):
        rate, offset = without(runs, k)
        errors.append(run.data - curve(rate, offset, k))
    found = refitted(bench, trial, folds)
    assert found.normalised["f_in_N"] == pytest.approx(found.rmse["f_in_N"] / NOISE)
    assert found.rmse["f_in_N"] == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=1e-3)
    last = found.squares[-4:].sum() * NOISE**2
    assert last == pytest.approx(float(errors[3] @ errors[3]), rel=1e-2)
    np.testing.assert_allclose(found.raw_squares["f_in_N"], found.squares * NOISE**2)


def errors_of(weighted, raw):
    return HeldOutFit({}, {}, np.array(weighted), {}, {"f_in_N": np.array(raw)})


@pytest.mark.parametrize(("raw", "part"), [(2.0, 0.8), (9.9, 0.1), (11.0, 0.1)])
def test_what_has_no_weight_is_a_gain_where_most_of_the_raw_squares_go(raw, part):
    """Where the weighted squares fall in half of the blocks alone, by a tenth of all."""
    without, with_it = errors_of([10.0] * 8, [10.0] * 8), errors_of([7.0, 11.0] * 4, [raw] * 8)
    found = gain_anywhere(without, with_it)
    assert found.part == pytest.approx(part)
    assert found.convincing is (raw == 2.0)
    clear = errors_of([5.0] * 8, [raw] * 8)
    assert gain_anywhere(without, clear).part == pytest.approx(0.5)


def test_each_channel_counts_by_its_own_squares():
    """A displacement in millimetres has a millionth of the squares of a force, and counts alike."""
    without = {"f_in_N": np.full(8, 4.0), "x_out_mm": np.full(8, 4e-6)}
    found = raw_gain(without, without | {"x_out_mm": np.full(8, 2e-6)})
    assert (found.part, found.convincing) == (pytest.approx(0.25), True)
    assert not raw_gain(without, without).convincing


def test_raw_squares_are_those_of_a_fit_in_each_block(fitted):
    runs, bench, trial, folds = fitted
    rigs = [{"rate": trial.solution.values[0], "offset": v} for v in trial.solution.values[1:]]
    bench = SimpleNamespace(**vars(bench), rig=lambda trial, k: rigs[k])
    parts = [
        part
        for run, rig in zip(runs, rigs, strict=True)
        for part in np.split(run.data - curve(rig["rate"], rig["offset"], run.k), 4)
    ]
    found = raw_squares(bench, trial, folds)
    np.testing.assert_allclose(found["f_in_N"], [float(part @ part) for part in parts])


def test_a_held_out_run_has_a_plausible_friction_of_its_own(fitted):
    """The last run's rate is 1.1 more: two deviations of 2 % of it are plausible."""
    runs, bench, trial, folds = fitted
    named = (replace(trial.unknowns[0], name="friction_coefficient"), *trial.unknowns[1:])
    found = refitted(bench, replace(trial, unknowns=named), folds, scatter=True)
    rate, offset = without(runs, 3)
    errors = runs[3].data - curve(rate + 0.04, offset, 3)
    assert found.by_run[3, "f_in_N"] == pytest.approx(np.sqrt(np.mean(errors**2)), rel=1e-3)


def test_a_step_that_ends_where_no_slope_leads_back_is_not_the_start(fitted, monkeypatch):
    """With a rate of e³ every run is flat from its third sample on."""
    runs, bench, trial, folds = fitted
    lost = np.array([3.0, *trial.solution.values[1:]])
    monkeypatch.setattr(module, "held_out_values", lambda *_: lost)
    rate, _ = without(runs, 1)
    assert refitted_values(bench, trial, folds, 1)[0] == pytest.approx(rate, abs=1e-3)
