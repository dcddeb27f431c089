"""Errors over bins of each signal, by hand, on a few samples."""

from types import SimpleNamespace

import numpy as np

from tests.diagnosis.test_signals import run_of
from tsas_cli.diagnosis.residual_map import binned, edges_of, residual_map
from tsas_cli.diagnosis.signals import DIRECTION


def test_bins_hold_equally_many_samples_each_once():
    signal, error = np.arange(24.0) ** 2, np.arange(24.0)
    edges = edges_of(signal, "x_in_mm")
    assert edges.size == 13
    assert (edges[0], edges[-1]) == (0.0, 23.0**2)
    bins = binned(signal, error, edges, "x_in_mm")
    assert sum(b.samples for b in bins) == 24
    assert {b.samples for b in bins} == {2}
    for k, one in enumerate(bins):
        assert (one.low, one.high) == ((2.0 * k) ** 2, (2.0 * k + 1.0) ** 2)
        assert one.mean == 2.0 * k + 0.5
        assert one.sd == 0.5
    assert bins[0].label.startswith("0 to ")


def test_labels_are_bins_of_their_own():
    direction = np.array([1.0, -1.0, -1.0, 1.0, 1.0])
    error = np.array([1.0, 2.0, 4.0, 5.0, 9.0])
    down, up = binned(direction, error, edges_of(direction, DIRECTION), DIRECTION)
    assert (down.label, down.mean, down.samples) == ("releasing", 3.0, 2)
    assert (up.label, up.mean, up.samples) == ("pulling", 5.0, 3)
    number = np.array([1.0, 1.0, 0.0, 1.0, 0.0])
    first, second = binned(number, error, edges_of(number, "run"), "run", ["a", "b"])
    assert (first.label, first.mean) == ("a", 6.5)
    assert (second.label, second.samples) == ("b", 3)


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
    assert [b.label for b in found["x_out_mm"][DIRECTION]] == ["releasing"]
