"""Lines between the two forces, read off forces that lie on such lines exactly, or nearly so."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification.phases import Segment
from tsas_cli.identification.transfer import tension_transfer

UP, DOWN = 1.5, 0.7  # f_in over f_out
C_UP, C_DOWN = 2.0, -1.0  # and what is added [N]
STROKE = 40


def run_of(run_id="a", *, bend=3.0, strokes=6, noise=0.0, seed=1, span=(20.0, 60.0)):
    """Return a run that slips in turns both ways; every stroke is one segment."""
    f_out, f_in, segments = [], [], []
    for k in range(strokes):
        up = k % 2 == 0
        force = np.linspace(*(span if up else span[::-1]), STROKE)
        f_out.append(force)
        f_in.append((UP if up else DOWN) * force + (C_UP if up else C_DOWN))
        phase = "contraction" if up else "loosening"
        segments.append(Segment(k * STROKE, (k + 1) * STROKE, phase))
    rng = np.random.default_rng(seed)
    channels = {
        "f_in_N": np.concatenate(f_in) + noise * rng.standard_normal(strokes * STROKE),
        "f_out_N": np.concatenate(f_out),
    }
    run = SimpleNamespace(
        run=SimpleNamespace(id=run_id, total_bend_rad=bend),
        channel=channels.get,
        noise={"f_out_N": 0.1},
        channels=channels,
    )
    return run, segments


def told(*runs):
    found = tension_transfer([r for r, _ in runs], [s for _, s in runs])
    return {(e.name, e.run): e for e in found}


def test_exact_lines_are_found_and_what_follows_from_them():
    found = {name: e.value for (name, _), e in told(run_of()).items()}
    assert found == pytest.approx(
        {
            "ratio_contraction": UP,
            "ratio_loosening": DOWN,
            "intercept_contraction": C_UP,
            "intercept_loosening": C_DOWN,
            "wrap": 0.5 * math.log(UP / DOWN),
            "constant_friction": 1.5,  # half of 2 − (−1)
            "offset": 0.5,  # half of 2 + (−1)
        }
    )


@pytest.mark.parametrize("seed", range(3))
def test_errors_are_those_of_lines_through_noisy_points(seed):
    """White noise: the plain formula, sd² (JᵀJ)⁻¹, which the jackknife scatters about."""
    noise = 0.5
    found = {name: e for (name, _), e in told(run_of(strokes=40, noise=noise, seed=seed)).items()}
    force = np.tile(np.linspace(20.0, 60.0, STROKE), 20)
    J = np.column_stack((force, np.ones(force.size)))
    plain = noise * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    expected = {
        "ratio_contraction": plain[0],
        "ratio_loosening": plain[0],
        "intercept_contraction": plain[1],
        "intercept_loosening": plain[1],
        "wrap": 0.5 * math.hypot(plain[0] / UP, plain[0] / DOWN),
        "constant_friction": 0.5 * math.sqrt(2.0) * plain[1],
        "offset": 0.5 * math.sqrt(2.0) * plain[1],
    }
    for name, error in expected.items():
        e = found[name]
        assert 0.6 * error < e.stderr < 1.6 * error, name
        half = 0.5 * (e.interval_high - e.interval_low)
        assert 1.9 * e.stderr < half < 3.0 * e.stderr
        assert 0.5 * (e.interval_high + e.interval_low) == pytest.approx(e.value)


def test_bends_are_told_apart_and_runs_of_one_bend_together():
    found = told(run_of("a"), run_of("b"), run_of("c", bend=1.5))
    assert {run for _, run in found} == {"a, b", "c"}


def test_gaps_are_left_out():
    run, segments = run_of()
    run.channels["f_in_N"][45:60] = np.nan
    run.channels["f_out_N"][100:110] = np.nan
    found = {name: e.value for (name, _), e in told((run, segments)).items()}
    assert found["wrap"] == pytest.approx(0.5 * math.log(UP / DOWN))


def test_what_does_not_tell_it():
    run, segments = run_of()
    del run.channels["f_in_N"]
    assert told((run, segments)) == {}
    assert told((run_of()[0], run_of()[1][::2])) == {}  # one direction alone
    assert told((run_of()[0], run_of()[1][:3])) == {}  # a single stroke down
    assert told(run_of(span=(20.0, 20.9))) == {}  # no more than ten times the noise
    assert told(run_of(span=(20.0, 21.1))) != {}
    few, parts = run_of(strokes=4)
    short = [Segment(s.first, s.first + 12, s.phase) for s in parts]
    assert told((few, short)) == {}  # 24 samples each way


def test_a_tension_that_falls_as_the_other_rises_is_no_capstan():
    run, segments = run_of()
    run.channels["f_in_N"] *= -1.0
    assert told((run, segments)) == {}
