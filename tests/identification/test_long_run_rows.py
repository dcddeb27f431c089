"""What a fit keeps of a long run, row by row, on pieces of a few rows."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import long_runs as long
from tsas_cli.numerics.conditioning_pieces import Cleaned
from tsas_cli.numerics.noise import Noise
from tsas_cli.recordings import pieces as reading


def part_of(start, n, reversals=(), begin=0.0):
    """Cleaned rows whose four columns tell their numbers, each in its own hundred."""
    k = start + begin + np.arange(float(n))
    turns = np.array(reversals, dtype=np.int64)
    return Cleaned(start, np.array([100.0 + k, 200.0 + k, 300.0 + k, 400.0 + k]), turns)


def rows_of(start, n, reversals=()):
    k = start + np.arange(n)
    return long.Rows(
        start, 0.5 * k, {"x_in_mm": part_of(start, n, reversals)},
        {"f_in_N": 500.0 + k}, k % 7 == 0,
    )  # fmt: skip


def run_of(rows, names=("x_in_mm",)):
    plan = SimpleNamespace(window_s=0.25, noise=0.1, smallest_reversal=0.3, interval_s=0.5)
    return long.LongRun(
        SimpleNamespace(id="a"),
        SimpleNamespace(rows=rows),
        "x_in_mm",
        dict.fromkeys(names, plan),
        {"f_in_N": Noise(0.2, 0.5)},
        60.0,
    )


@pytest.fixture
def pieces_of(monkeypatch):
    return lambda rows: monkeypatch.setattr(reading, "MOST_ROWS", rows)


@pytest.mark.parametrize(("rows", "every"), [(100, 1), (101, 2), (200, 2), (201, 3)])
def test_so_many_samples_are_kept_that_they_fit_in_a_piece(pieces_of, rows, every):
    pieces_of(100)
    assert run_of(rows).every == every


def test_rows_are_thinned_alike_and_turns_are_places_among_them(pieces_of):
    """A fit sees the first twenty rows, every fifth, the turns and the last."""
    pieces_of(20)
    run = run_of(98)
    kept = [run.thin(rows_of(0, 40, [22, 31])), run.thin(rows_of(40, 58, [43, 96]))]
    first, second = ([*range(20), 20, 22, 25, 30, 31, 35], [40, 43, *range(45, 96, 5), 96, 97])
    for rows, at, turns in ((kept[0], first, [22, 31]), (kept[1], second, [43, 96])):
        part = rows.cleaned["x_in_mm"]
        assert part.apart_s.tolist() == (400 + np.array(at)).tolist()
        assert [at[place] for place in part.reversals] == turns
    prepared = run.thinned(kept)
    whole = np.array([*first, *second])
    conditioned = prepared.conditioned["x_in_mm"]
    found = np.array([conditioned.values, conditioned.sd, conditioned.unseen])
    assert (found - whole == [[100], [200], [300]]).all()
    assert whole[conditioned.reversals].tolist() == [0, 22, 31, 43, 96, 97]
    told = conditioned.window_s, conditioned.noise, conditioned.smallest_reversal
    assert told == (0.25, 0.1, 0.3)
    assert prepared.time_s.tolist() == (0.5 * whole).tolist()
    assert prepared.measured["f_in_N"].tolist() == (500 + whole).tolist()
    assert (prepared.every, prepared.all_rows, prepared.session_s) == (5, 98, 60.0)
    assert prepared.noise == {"f_in_N": 0.2}
    assert prepared.noises == {"f_in_N": Noise(0.2, 0.5**5)}  # of every fifth row
    assert prepared.in_gap.tolist() == (whole % 7 == 0).tolist()
