"""How finely a run is known, its hashes, which stretch of them is evidence, and how it is said."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece
from tsas_cli.recordings.quality.copies.rows import Reader, RowSpan, common_grid
from tsas_cli.recordings.quality.copies.search import Copy, _shifts, contradictions, stretches

N = 2000
RNG = np.random.default_rng(9)
T = 5.0 + 0.01 * np.arange(N)
COLUMNS = {
    "time_s": T,
    "x_in_mm": 4.0 * np.sin(T) - 20.0 + 0.1 * RNG.standard_normal(N),
    "f_in_N": 0.5 * np.round(2.0 * (30.0 + 9.0 * np.cos(T))),
    "f_out_N": np.full(N, 7.0),
    "temperature_C": 20.0 + 0.1 * RNG.standard_normal(N),
}


def run(name, **said):
    return Run(id=name, file=f"{name}.parquet", sha256="0" * 64, **said)


@pytest.fixture
def reader(monkeypatch):
    """Return a function that gives a reader of one run, cut at some rows."""

    def made(*cuts, **changes):
        one = Reader(read_dataset(Path("datasets/paper-groups")), strict=True)
        columns = COLUMNS | changes
        parts = [
            Piece(a, {name: values[a:b] for name, values in columns.items()})
            for a, b in pairwise([0, *cuts, N])
        ]
        monkeypatch.setattr(one, "pieces", lambda _: iter(parts))
        return one

    return made


@pytest.mark.parametrize("cuts", [(), (700,), (512, 1500)])
def test_a_run_is_known_however_it_is_cut(reader, cuts):
    one = reader(*cuts)
    found = one.searched(run("a"), 3)
    assert (found.number, found.all) == (3, RowSpan(0, N, 5.0, T[-1]))
    assert found.interval_s == pytest.approx(0.01)
    assert found.increases
    assert found.channels == {"x_in_mm": (0.0, 0.0625), "f_in_N": (0.5, 0.0)}  # 2⁻⁴ mm of 0.1
    rows = one.hashed(found, common_grid(found, found))
    np.testing.assert_array_equal(rows.row, np.arange(N))
    np.testing.assert_array_equal(rows.time_s, T)
    whole = reader()
    expected = whole.hashed(whole.searched(run("a"), 3), common_grid(found, found))
    np.testing.assert_array_equal(rows.hashes, expected.hashes)
    np.testing.assert_array_equal(np.sort(rows.hashes[rows.first]), np.unique(expected.hashes))
    assert rows.noisy
    assert set(rows.nats) == {0.0, 1.25}  # of x_in alone, which has noise


def test_hashes_are_equal_where_all_values_are_to_what_both_runs_resolve(reader):
    fine, changed = reader(), COLUMNS["x_in_mm"].copy()
    changed[[30, 40]] += 0.09, 1e-12
    coarse = reader(x_in_mm=changed, f_in_N=2.0 * np.round(0.5 * COLUMNS["f_in_N"]))
    one, other = fine.searched(run("a"), 0), coarse.searched(run("b"), 1)
    grid = common_grid(one, other)
    assert grid == common_grid(other, one) == (("f_in_N", 2.0), ("x_in_mm", 0.015625))
    ours, theirs = fine.hashed(one, grid), coarse.hashed(other, grid)
    assert np.flatnonzero(ours.hashes != theirs.hashes).tolist() == [30]


def test_a_run_whose_time_stands_still_is_known_as_such(reader):
    still = T.copy()
    still[900] = still[899]
    assert not reader(time_s=still).searched(run("a"), 0).increases
    assert not reader(900, time_s=still).searched(run("a"), 0).increases


def test_a_stretch_is_evidence_by_what_its_rows_tell():
    """40 nats are asked for; in noise up to 16 consecutive rows and two fifths may differ."""
    equal = np.ones(100, dtype=np.bool_)
    equal[[40, 41]] = False

    def found(nats, *, noisy):
        told = nats * np.ones(100)
        return [ends.tolist() for ends in stretches(equal, told, noisy=noisy)]

    assert found(0.99, noisy=False) == [[42, 99]]
    assert found(1.0, noisy=False) == [[0, 39], [42, 99]]
    assert found(0.68, noisy=False) == []
    assert found(0.5, noisy=True) == [[0, 99]]
    equal[40:57] = False
    assert found(1.0, noisy=True) == [[0, 39], [57, 99]]
    equal[:] = np.arange(100) % 5 < 3
    assert found(1.0, noisy=True) == [[0, 97]]
    equal[:] = np.arange(100) % 5 < 2
    assert found(1.0, noisy=True) == []


def test_the_most_frequent_differences_are_shifts():
    apart_s = np.concatenate((RNG.uniform(-9.0, 9.0, 50), [2.0] * 9, [-3.004] * 7, [-2.996] * 7))
    assert list(_shifts(apart_s, 0.01, 8.0)) == pytest.approx([-3.0, 2.0], abs=0.005)


def test_conditions_differ_by_more_than_a_thousandth():
    one = run("a", preload_N=25.0, total_bend_rad=3.1416)
    assert contradictions(one, run("b", preload_N=25.02, total_bend_rad=math.pi)) == ()
    other = run("b", preload_N=25.03, load="force", temperature_C=20.0)
    assert contradictions(one, other) == ("preload_N", "load")
    said = Copy(one, other, *[RowSpan(0, 9, 0.0, 8.0)] * 3, contradicts=("preload_N",))
    assert said.contradiction == ", but the manifest says preload_N = 25 here and 25.03 there"


WHOLE = RowSpan(0, 1000, 0.0, 10.0)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({}, "holds the samples of run b"),
        ({"shift_s": 0.0099}, "holds the samples of run b"),  # less than a sample
        ({"shift_s": 0.0101}, "holds the samples of run b, its time shifted by -0.0101 s"),
        ({"every": 2}, "holds every 2nd sample of run b"),
        ({"every": 11}, "holds every 11th sample of run b"),
        ({"every": 112}, "holds every 112th sample of run b"),
        ({"every": 123}, "holds every 123rd sample of run b"),
        (
            {"span": RowSpan(100, 1000, 1.0, 10.0), "shift_s": 3.0},
            "holds, from 1 s to 10 s, the samples of run b from 4 s to 13 s",
        ),
        (
            {"all_of_other": RowSpan(0, 2000, 0.0, 20.0), "shift_s": 3.0},
            "holds the samples of run b from 3 s to 13 s",
        ),
    ],
)
def test_a_copy_is_said_with_what_it_holds(how, said):
    told = {"span": WHOLE, "all_of_run": WHOLE, "all_of_other": WHOLE} | how
    assert Copy(run("a"), run("b"), **told).sentence == said
