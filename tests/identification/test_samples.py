"""Which samples a fit uses, and at which it simulates."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import run_simulation as s

N = 60


def run_of(x, *, gap=(), noise=0.1, smallest=0.5, **measured):
    """Return a run driven by x; `measured` are its channels, all of them known throughout."""
    x = np.asarray(x, dtype=float)
    in_gap = np.zeros(x.size, dtype=bool)
    in_gap[list(gap)] = True
    channels = {"f_in_N": np.zeros(x.size)} | measured
    return SimpleNamespace(
        run=SimpleNamespace(id="a"),
        drive_column="x_in_mm",
        drive=SimpleNamespace(values=x),
        conditioned={
            "x_in_mm": SimpleNamespace(
                values=x, smallest_reversal=smallest, reversals=np.array([0, x.size - 1])
            )
        },
        in_gap=in_gap,
        measured=channels,
        noise=dict.fromkeys(channels, noise),
    )


@pytest.fixture
def forgets(monkeypatch):
    """Have the tendon forget its start at a given sample."""
    return lambda first: monkeypatch.setattr(s, "first_determined_sample", lambda rig, drive: first)


UP = np.arange(N, dtype=float)


def kept(run):
    return {name: at.tolist() for name, at in s.fitted_samples(run, None).items()}


def test_the_drive_has_to_travel_as_far_again(forgets):
    """It forgets at 10 mm of travel: from 20 mm on; up to the last 0.5 mm it counts."""
    forgets(10)
    assert kept(run_of(UP)) == {"f_in_N": list(range(20, N - 1))}
    there_and_back = np.concatenate((np.arange(8.0), np.arange(6.0, -46.0, -1.0)))
    assert np.abs(np.diff(there_and_back)).tolist() == [1.0] * (N - 1)
    assert kept(run_of(there_and_back)) == {"f_in_N": list(range(20, N - 1))}
    forgets(0)
    assert kept(run_of(UP)) == {"f_in_N": list(range(N - 1))}


def test_gaps_of_the_drive_and_of_a_channel_do_not_count(forgets):
    forgets(5)
    out = np.zeros(N)
    out[[30, 31]] = np.nan
    found = kept(run_of(UP, gap=(40, 41), f_out_N=out))
    all_but = [k for k in range(10, N - 1) if k not in (40, 41)]
    assert found == {"f_in_N": all_but, "f_out_N": [k for k in all_but if k not in (30, 31)]}


@pytest.mark.parametrize(("smallest", "last"), [(0.5, 58), (3.0, 55), (3.5, 55), (100.0, 59)])
def test_a_turn_that_noise_may_hide_is_left_out_with_what_follows(forgets, smallest, last):
    """What is further from the last place than the smallest reversal counts: 4 mm and more of 3."""
    forgets(0)
    assert kept(run_of(UP, smallest=smallest))["f_in_N"] == list(range(last + 1))


def test_sixteen_samples_are_enough_and_noise_has_to_be_known(forgets):
    forgets(0)
    short = np.where(np.arange(N) < 16, 1.0, np.nan)
    shorter = np.where(np.arange(N) < 15, 1.0, np.nan)
    run = run_of(UP, f_out_N=short, x_out_mm=shorter)
    assert set(kept(run)) == {"f_in_N", "f_out_N"}
    for noise, enters in ((0.0, False), (np.nan, False), (1e-3, True)):
        run.noise["f_in_N"] = noise
        assert ("f_in_N" in kept(run)) == enters


def test_what_is_left_out_is_said():
    run = run_of(UP, f_out_N=UP, x_out_mm=UP)
    everything = dict.fromkeys(run.measured, UP)
    assert s.left_out_notes(run, everything) == []
    few = "of run a does not enter the fit: it has too few samples."
    assert s.left_out_notes(run, {"f_in_N": UP}) == [f"f_out_N {few}", f"x_out_mm {few}"]
    run.noise["f_in_N"] = 0.0
    flat = "f_in_N of run a does not enter the fit: it is constant."
    assert s.left_out_notes(run, {"f_out_N": UP}) == [flat, f"x_out_mm {few}"]
    whole = s.left_out_notes(run, {})
    assert whole[0] == flat
    assert whole[1].startswith("Run a does not enter the fit: too few samples after")
    assert len(whole) == 2
    run.noise = dict.fromkeys(run.measured, 0.0)
    assert len(s.left_out_notes(run, {})) == 3
    assert all("is constant" in sentence for sentence in s.left_out_notes(run, {}))


def points(n, reversals):
    conditioned = SimpleNamespace(reversals=np.array(reversals))
    run = SimpleNamespace(
        time_s=np.arange(float(n)), drive_column="x_in_mm", conditioned={"x_in_mm": conditioned}
    )
    return s.points(run)


def test_a_long_run_is_thinned_but_after_its_reversals():
    """30,000 samples: every seventh, four strides of seven after each reversal, and the last."""
    found = points(30_000, [0, 10_001, 29_999])
    close = set(range(10_001, 10_001 + 28)) | set(range(28))
    assert set(found) == set(range(0, 30_000, 7)) | close | {29_999}
    assert points(30_000, [0, 29_990, 29_999])[-10:].tolist() == list(range(29_990, 30_000))
    for short in (9, 7999):
        assert points(short, [0, short - 1]).tolist() == list(range(short))
