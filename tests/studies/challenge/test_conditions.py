"""What the conditions of a case add to its rig and its sensors, and that clean ones add nothing."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.bench import RUNS, SENSORS, clean_run, drawn_bench
from tsas_studies.challenge.cases import Hidden, cases
from tsas_studies.challenge.conditions import drawn_nuisance
from tsas_studies.challenge.make import answer, make
from tsas_studies.challenge.rig.sensors import measure
from tsas_studies.challenge.truth import TrueCase, read_truth

BENCH = drawn_bench(np.random.default_rng(1))
DRAWN = [drawn_nuisance("realistic", RUNS, np.random.default_rng(seed)) for seed in range(60)]


def test_clean_conditions_add_nothing():
    nuisance = drawn_nuisance("clean", RUNS, np.random.default_rng(1))
    assert replace(BENCH, nuisance=nuisance) == BENCH
    _, sensors = clean_run(BENCH, (), "a", rate_Hz=50.0)
    assert sensors == replace(SENSORS, rate_Hz=50.0)


def test_realistic_conditions_are_within_what_is_documented():
    friction = [factor for n in DRAWN for factor in n.friction.values()]
    assert 0.985 <= min(friction) < 0.987
    assert 1.013 < max(friction) <= 1.015
    assert {n.along for n in DRAWN} == {-0.15, 0.15}
    for name, most in (("f_in_of_f_out", 0.003), ("f_out_of_f_in", 0.003), ("f_in_per_N", 5e-5)):
        values = [getattr(n, name) for n in DRAWN]
        assert -most <= min(values) < -0.8 * most
        assert 0.8 * most < max(values) <= most
    assert {(n.slow_N, n.slow_mm) for n in DRAWN} == {(0.05, 0.005)}


def test_slow_noise_is_as_large_as_the_white_one_and_remembers_a_second():
    slow = drawn_nuisance("slow", RUNS, np.random.default_rng(1))
    clean, sensors = clean_run(BENCH, (), "a", rate_Hz=50.0)
    same, slow_sensors = clean_run(replace(BENCH, nuisance=slow), (), "a", rate_Hz=50.0)
    np.testing.assert_array_equal(same.columns["f_in_N"], clean.columns["f_in_N"])
    quiet, noisy = (
        [measure(clean, of, seed=seed) for seed in range(8)] for of in (sensors, slow_sensors)
    )
    for channel, size in (("f_in_N", 0.1), ("f_out_N", 0.1), ("x_out_mm", 0.01)):
        off = [b[channel] - a[channel] for a, b in zip(quiet, noisy, strict=True)]
        assert np.std(off) == pytest.approx(size, rel=0.25)
        together = np.mean([np.corrcoef(o[:-25], o[25:])[0, 1] for o in off])
        assert 0.3 < together < 0.8  # exp(−½) = 0.61, less what so short a run cuts off
    assert slow_sensors.x_in_mm == SENSORS.x_in_mm


def test_friction_and_scales_are_the_rigs_and_a_hidden_cause_keeps_its_value():
    bench = replace(BENCH, nuisance=DRAWN[0])
    n = DRAWN[0]
    hidden = (Hidden("force_sensor_curvature", {"f_in_per_N": 1e-3}),)
    _, sensors = clean_run(bench, hidden, "b", rate_Hz=25.0)
    assert sensors.f_in_N.curvature == 1e-3
    assert sensors.f_out_N.curvature == n.f_out_per_N
    assert (sensors.f_in_of_f_out, sensors.f_out_of_f_in) == (n.f_in_of_f_out, n.f_out_of_f_in)
    # A run's own friction is what a rig with that coefficient has.
    alone = replace(n, along=0.0)
    told = BENCH.nominal | {
        "friction_coefficient": BENCH.nominal["friction_coefficient"] * n.friction["b"]
    }
    one, _ = clean_run(replace(BENCH, nuisance=alone), (), "b", rate_Hz=25.0)
    other, _ = clean_run(replace(BENCH, nominal=told), (), "b", rate_Hz=25.0)
    np.testing.assert_allclose(one.columns["f_in_N"], other.columns["f_in_N"], atol=1e-9)


def test_a_realistic_case_is_the_clean_one_with_what_its_conditions_add(tmp_path):
    twins = [case for case in cases(5) if case.name in ("nothing 1", "nothing 1, realistic")]
    make(tmp_path, twins, rate_Hz=25.0)
    told = json.loads((tmp_path / "answers.json").read_text(encoding="utf-8"))["cases"]
    named = {case["conditions"]: (name, case) for name, case in told.items()}
    assert set(named) == {"clean", "realistic"}
    (one, clean), (other, realistic) = named["clean"], named["realistic"]
    assert one != other
    assert clean["nominal"] == realistic["nominal"]
    assert realistic["nuisance"]["slow_N"] == 0.05
    assert clean["nuisance"]["slow_N"] == 0.0
    assert {c.conditions for c in read_truth(tmp_path).cases.values()} == {"clean", "realistic"}
    first, second = (read_dataset(tmp_path / "cases" / name / "dataset") for name in (one, other))
    for a, b in zip(first, second, strict=True):
        off = b.columns["f_out_N"] - a.columns["f_out_N"]
        assert 0.03 < np.std(off) < 0.4


def test_what_is_hidden_beyond_the_catalogue_is_sealed():
    clean = [case for case in cases(5) if case.conditions == "clean"]
    wanted = {"mixed, size 0.4", "encoder_play, size 1"} | {
        case.name for case in clean if case.kind == "triple"
    }
    answers = [answer(case, BENCH) for case in clean if case.name in wanted]
    truth = {case.unknown or case.kind: case for case in map(TrueCase.model_validate, answers)}
    assert set(truth) == {"mixed", "encoder_play", "triple"}
    assert len(truth["mixed"].unknown_parameters) == 3
    assert truth["encoder_play"].unknown_parameters.keys() == {"play_mm"}
    assert truth["encoder_play"].kind == "near"
    assert len(truth["triple"].effects) == 3
