"""Every stage that fits, or weighs evidence, counts a sample once and says where it was twice."""

import json
from functools import cache

import numpy as np
import pytest

import tsas_cli as tsas
from tests.drives import drive_dataset
from tsas_cli.diagnosis import further_runs, plan
from tsas_cli.recordings import pieces
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.motions import nested, sine
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

RIG = Rig(proximal_length_mm=150.0, cells=60)
SAID = "so that no sample counts twice."


@cache
def recorded():
    return measure(simulate(RIG, nested(rate_Hz=100.0)), Sensors(rate_Hz=50.0), seed=1)


def dataset(folder, other=None, **runs):
    """Write runs under the same conditions, but for run b where it has others."""
    made = [
        Run(name, columns, conditions(RIG) | (other or {} if name == "b" else {}))
        for name, columns in runs.items()
    ]
    return read_dataset(write_dataset(folder, made))


def rows(columns, *between):
    return {name: values[slice(*between)] for name, values in columns.items()}


COPIES = {
    "four times": (lambda A: dict.fromkeys("abcd", A), ["b", "c", "d"]),
    "later": (lambda A: {"a": A, "b": A | {"time_s": A["time_s"] + 3.0}}, ["b"]),
    "cut out": (lambda A: {"b": rows(A, 100, 600), "a": A}, ["b"]),
    "every second": (lambda A: {"a": A, "b": rows(A, None, None, 2)}, ["b"]),
}


def overlapping(folder):
    """Write two runs, of which the second begins before the first ends."""
    return dataset(folder, a=rows(recorded(), 0, 700), b=rows(recorded(), 400, None))


def found(result):
    """Return what a stage found: what it was told of the dataset and of copies left out."""
    told = {"dataset", "chosen", "cannot_tell", "parameters"}
    summary = {key: value for key, value in result.summary.items() if key not in told}
    return json.loads(json.dumps(summary, default=np.ndarray.tolist))


def parameters(result):
    return [e for e in result.summary["parameters"] if e["origin"] == "fitted"]


def copied(result):
    """Return the runs that are said to be copies, and what else cannot be told."""
    said = result.summary["cannot_tell"]
    copies = [sentence.split()[1] for sentence in said if sentence.endswith(SAID)]
    return copies, [sentence for sentence in said if not sentence.endswith(SAID)]


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    return dataset(tmp_path_factory.mktemp("once"), a=recorded())


@pytest.fixture(scope="module")
def calibrated(once):
    return tsas.calibrate(once)


@pytest.mark.parametrize("kind", COPIES)
def test_a_calibration_with_copies_is_that_without(tmp_path, calibrated, kind):
    copies, names = COPIES[kind]
    result = tsas.calibrate(dataset(tmp_path / "d", **copies(recorded())), out=tmp_path / "out")
    assert found(result) == found(calibrated)
    assert parameters(result) == parameters(calibrated)
    assert copied(result) == (names, copied(calibrated)[1])
    assert set(names) == {line.split()[2] for line in str(result).splitlines() if SAID in line}
    assert json.loads((tmp_path / "out" / "calibration.json").read_text()) == result.summary


def test_a_diagnosis_with_four_copies_is_that_of_one_run(tmp_path):
    slow, names = rows(recorded(), None, None, 2), ["b", "c", "d"]
    before = tsas.diagnose(dataset(tmp_path / "one", a=slow))
    after = tsas.diagnose(dataset(tmp_path / "four", a=slow, **dict.fromkeys(names, slow)))
    assert before.verdict == "ambiguous"  # one run alone does not tell a free tendon from a spring
    assert after.verdict == before.verdict
    assert found(after) == found(before)
    assert copied(after) == (names, copied(before)[1])


def test_a_shared_stretch_counts_in_one_of_two_runs(tmp_path, calibrated):
    """Two halves that overlap tell as much as the whole: no narrower intervals, the same values."""
    parts = overlapping(tmp_path)
    result = tsas.calibrate(parts)
    assert copied(result)[0] == ["b"]
    assert result.summary["cannot_tell"][0].startswith(
        "Run b holds, from 8 s to 13.98 s, the samples of run a from 8 s to 13.98 s: there it has"
    )
    whole = {e["name"]: e for e in parameters(calibrated) if e["run"] is None}
    split = {e["name"]: e for e in parameters(result) if e["run"] is None}
    for name in ("friction_coefficient", "load_stiffness_N_per_mm"):
        assert abs(split[name]["value"] - whole[name]["value"]) < whole[name]["stderr"]
        assert split[name]["stderr"] > 0.85 * whole[name]["stderr"]


def test_the_shared_stretch_is_left_out_of_a_run_in_pieces_too(tmp_path, monkeypatch):
    parts = overlapping(tmp_path)
    before = tsas.calibrate(parts)
    monkeypatch.setattr(pieces, "MOST_ROWS", 600)
    after = tsas.calibrate(parts)
    assert copied(after)[0] == ["b"]
    for name in ("friction_coefficient", "load_stiffness_N_per_mm"):
        one, other = (next(e for e in parameters(r) if e["name"] == name) for r in (before, after))
        assert other["value"] == pytest.approx(one["value"], abs=2.0 * one["stderr"])


def test_a_plan_with_copies_is_that_without(tmp_path, monkeypatch):
    monkeypatch.setattr(plan, "_proposals", lambda *_: [])  # no further runs, which take long
    monkeypatch.setattr(further_runs, "candidates", lambda *_: [])
    quick = measure(simulate(RIG, sine(rate_Hz=60.0, periods=1.5)), Sensors(rate_Hz=30.0), seed=1)
    alone = tsas.plan(dataset(tmp_path / "one", a=quick))
    twice = tsas.plan(dataset(tmp_path / "two", a=quick, b=quick))
    assert found(twice) == found(alone)
    assert copied(twice) == (["b"], copied(alone)[1])


@pytest.mark.parametrize("stage", ["calibrate", "diagnose", "plan", "identify_harmonic_drive"])
def test_the_same_samples_under_other_conditions_stop_every_fit(tmp_path, stage):
    data = dataset(
        tmp_path / "d", {"total_bend_rad": 1.0}, a=recorded(), b=rows(recorded(), 100, None)
    )
    with pytest.raises(InputError) as stopped:
        getattr(tsas, stage)(data, out=tmp_path / "out")
    assert "run b holds the samples of run a from 2 s to " in str(stopped.value)
    assert "total_bend_rad = 1 here and 3.14159 there" in str(stopped.value)
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    (chirp,) = drive_dataset(tmp_path_factory.mktemp("drive"), only=("chirp",), duration_s=4.0)
    return dict(chirp.columns)


def drives(folder, **runs):
    return read_dataset(write_dataset(folder, [Run(name, c) for name, c in runs.items()]))


def test_a_drive_is_identified_from_each_sample_once(tmp_path, drive):
    alone = tsas.identify_harmonic_drive(drives(tmp_path / "one", a=drive))
    twice = tsas.identify_harmonic_drive(drives(tmp_path / "two", a=drive, b=drive))
    assert found(twice) == found(alone)
    assert parameters(twice) == parameters(alone)
    assert copied(twice) == (["b"], copied(alone)[1])


def test_a_stretch_that_two_runs_of_a_drive_share_has_no_weight_in_one(tmp_path, drive):
    n = drive["time_s"].size
    runs = {"a": rows(drive, 0, 3 * n // 4), "b": rows(drive, n // 2, n)}
    result = tsas.identify_harmonic_drive(drives(tmp_path, **runs))
    assert copied(result)[0] == ["b"]
    samples = {name: row["samples"] for name, row in result.summary["runs"].items()}
    assert sum(samples.values()) == n
    simulated = result["b"].columns["x_in_mm"]
    assert np.isnan(simulated[: n // 4]).all()
    assert np.isfinite(simulated[-samples["b"] :]).all()
    assert result.summary["runs"]["b"]["rmse"] == pytest.approx(
        result.summary["runs"]["a"]["rmse"], rel=0.2
    )
