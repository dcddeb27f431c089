"""What is left and where, step by step: signals, bins, means, one band, on a few samples."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.test_signals import DIRECTION, run_of
from tsas_cli.diagnosis import remainder as r
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.residual_map import binned, edges_of, residual_map
from tsas_cli.diagnosis.signals import AtResiduals, signals_at_residuals, signals_of

ROWS = 400
TIME_S = 5.0 + 0.02 * np.arange(ROWS)


def test_the_largest_value_is_in_the_last_bin_and_the_smallest_in_the_first():
    signal = np.arange(25.0)
    edges = edges_of(signal, "x_in_mm")
    np.testing.assert_allclose(edges, np.arange(0.0, 25.0, 2.0))
    bins = binned(signal, signal, edges, "x_in_mm")
    assert [b.samples for b in bins] == [2] * 11 + [3]
    assert (bins[-1].high, bins[0].low) == (24.0, 0.0)
    assert bins[-1].label == "22 to 24"
    # Edges of more samples than these: what lies below the first one is in the first bin.
    (below,) = binned(np.array([-1.0, 0.5]), np.array([1.0, 2.0]), np.array([0.0, 1.0]), "x_in_mm")
    assert (below.samples, below.label) == (2, "0 to 1")


class Errors:
    """A run of seven samples (tests of signals) with an error at some samples of a channel."""

    def __init__(self, run_id, errors, samples):
        self.run = run_of()
        self.run.run = SimpleNamespace(id=run_id)
        self.samples = {name: np.array(at) for name, at in samples.items()}
        self.given = {name: np.array(e, dtype=float) for name, e in errors.items()}

    def predict(self, rig):
        return {"f_in_N": 10.0 * rig + np.arange(7.0)}

    def errors(self, rig):
        return self.given


def test_a_map_holds_measured_less_simulated_over_each_signal():
    runs = [
        Errors("first", {"f_in_N": [1.0, 3.0]}, {"f_in_N": [0, 2]}),
        Errors("second", {"f_in_N": [-5.0], "x_out_mm": [8.0]}, {"f_in_N": [6], "x_out_mm": [3]}),
    ]
    bench = SimpleNamespace(
        errors_for=lambda trial: runs, rig=lambda trial, k: float(k), closed=runs
    )
    found = residual_map(bench, None)
    assert set(found) == {"f_in_N", "x_out_mm"}
    by_run = found["f_in_N"]["run"]
    assert [(b.label, b.mean, b.samples) for b in by_run] == [
        ("first", -2.0, 2),
        ("second", 5.0, 1),
    ]
    forces = found["f_in_N"]["f_in_N"]
    assert (forces[0].low, forces[-1].high) == (0.0, 16.0)  # 10 + 6 of the second run
    assert sum(b.samples for b in forces) == 3
    (out,) = found["x_out_mm"]["run"]
    assert (out.label, out.mean, out.low) == ("second", -8.0, 1.0)
    assert [b.label for b in found["x_out_mm"][DIRECTION]] == ["letting go"]


def test_samples_before_the_first_and_after_the_last_reversal():
    """They belong to the first and to the last stroke."""
    x = np.array([2.0, 1.0, 0.0, 1.0, 3.0, 2.5, 2.0])
    found = signals_of(run_of(reversals=np.array([2, 4]), values=x), x)
    np.testing.assert_array_equal(
        found["travel_since_reversal_mm"], [2.0, 1.0, 0.0, 1.0, 3.0, 2.5, 2.0]
    )
    np.testing.assert_array_equal(found[DIRECTION], 1.0)
    alone = signals_of(run_of(reversals=np.array([3, 5, 6]), values=x), x)
    np.testing.assert_array_equal(
        alone["travel_since_reversal_mm"], np.abs(x - np.array([1.0, 1, 1, 1, 1, 2.5, 2.5]))
    )
    np.testing.assert_array_equal(alone[DIRECTION], [1.0, 1, 1, 1, 1, 1, -1])


class Run:
    """A run of errors at some of its samples."""

    def __init__(self, errors, samples=None, time_s=TIME_S):
        self.run = SimpleNamespace(
            time_s=time_s,
            drive_column="x_in_mm",
            conditioned={
                "x_in_mm": SimpleNamespace(
                    values=np.arange(float(time_s.size)), reversals=np.array([0, time_s.size - 1])
                )
            },
        )
        self.given = errors
        everything = np.arange(time_s.size)
        self.samples = dict.fromkeys(errors, everything if samples is None else samples)

    def errors(self, rig):
        return self.given

    def delays(self, rig):
        return {name: np.zeros(2) for name in self.given}

    def predict(self, rig):
        return {"f_in_N": 7.0 * np.arange(float(self.run.time_s.size))}


def bench_of(*runs):
    channels = sorted({name for run in runs for name in run.given})
    return SimpleNamespace(
        rigs=[None] * len(runs),
        rig=lambda trial, k: None,
        errors_for=lambda trial: runs,
        closed=runs,
        channels=channels,
    )


def test_a_signal_is_taken_in_the_middle_of_the_samples_of_each_mean():
    """Of 2500 samples three at a time make a mean: the second one of each, the last alone."""
    time_s = 0.01 * np.arange(2600)
    samples = np.arange(50, 2550)
    given = {"f_out_N": np.zeros(2500), "x_out_mm": np.zeros(2500)}
    found = signals_at_residuals(bench_of(Run(given, samples, time_s)), None)
    signals, channel = found.signals, found.channel
    middle = np.minimum(np.arange(51, 2551, 3), 2549)
    assert middle.size == 834
    np.testing.assert_array_equal(signals["x_in_mm"], np.tile(middle, 2))
    np.testing.assert_array_equal(signals["f_in_N"], 7.0 * np.tile(middle, 2))
    np.testing.assert_array_equal(channel, np.repeat([0, 1], 834))


def swing(frequency_Hz, size=1.0):
    return size * np.sin(2.0 * np.pi * frequency_Hz * (TIME_S - TIME_S[0]))


NOISE = np.random.default_rng(1).standard_normal((8, ROWS))


@pytest.mark.parametrize(
    ("runs", "of", "said"),
    [(2, 2, True), (1, 2, False), (1, 1, False), (2, 5, True), (2, 6, False), (3, 6, True)],
)
def test_half_of_the_runs_have_to_swing_and_two_at_the_least(runs, of, said):
    made = [Run({"f_in_N": swing(5.0, 3.0) + NOISE[k]}) for k in range(runs)]
    made += [Run({"f_in_N": NOISE[4 + k % 4]}) for k in range(of - runs)]
    assert (r._oscillation(bench_of(*made), None) is not None) == said


def test_the_frequency_is_the_median_and_the_channels_are_named():
    made = [
        Run({"x_out_mm": swing(5.0), "f_in_N": swing(5.0)}),
        Run({"f_in_N": swing(9.0)}),
        Run({"f_in_N": NOISE[0]}),
    ]
    # 400 samples of 20 ms: a bin is 1/7.98 Hz wide.
    assert (
        r._oscillation(bench_of(*made), None) == "time_s (f_in_N and x_out_mm oscillate at 5.01 Hz)"
    )


@pytest.mark.parametrize(("cycles", "said"), [(1, False), (2, True)])
def test_an_oscillation_with_the_motion_is_not_its_own(cycles, said):
    """The drive makes one stroke, half a cycle: 2.5 of that is more than one cycle."""
    turn = 2.0 * np.pi * np.arange(ROWS) / ROWS
    swing = np.cos(cycles * turn) + 0.1 * NOISE[0]
    assert (r._oscillation(bench_of(*[Run({"f_in_N": swing})] * 2), None) is not None) == said


def left_of(*errors, signals=None):
    """Residuals are the errors of single samples; four folds of blocks of twenty."""
    runs = [Run(e) for e in errors]
    residual = np.concatenate([np.concatenate(list(e.values())) for e in errors])
    block = np.arange(residual.size) // 20
    run = np.repeat(np.arange(len(runs)), [sum(e.size for e in one.values()) for one in errors])
    folds = Folds(block % 4, block, run, by_run=False)
    trial = SimpleNamespace(unknowns=[], solution=SimpleNamespace(residual=residual))
    bench = bench_of(*runs)
    at = signals_at_residuals(bench, trial)
    if signals is not None:
        at = AtResiduals(signals, np.repeat([0, 1], ROWS))
    return r.remainder(bench, trial, folds, at, np.zeros((residual.size, 0)))


def test_what_is_explained_is_of_all_squares_of_the_channel_and_what_is_not_is_none():
    """Squares of 1 + 8, the latter a straight line over the place."""
    line = np.linspace(-1.0, 1.0, ROWS) * np.sqrt(3.0 * 8.0)
    found = left_of({"f_in_N": line + NOISE[0]}, {"f_in_N": line + NOISE[1]})
    assert found.explained["f_in_N"] == pytest.approx(8.0, rel=0.05)
    assert found.mean_square == pytest.approx(9.0, rel=0.05)
    quiet = left_of({"f_in_N": 0.1 * NOISE[0]}, {"f_in_N": 0.1 * NOISE[1]})
    assert quiet.explained == {"f_in_N": 0.0}
    assert quiet.mean_square == pytest.approx(0.01, rel=0.1)
