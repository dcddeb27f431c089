import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import tomlkit

from tests.comparing.made import NOMINAL, calibrated
from tsas_cli.comparing.compare import compare
from tsas_cli.comparing.predictions import Predictions
from tsas_cli.comparing.sentences import findings, notes
from tsas_cli.comparing.sides import read_side
from tsas_cli.comparing.stage import record_of, tables
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.stages.calibrate import calibrate
from tsas_cli.stages.simulate import simulate
from tsas_cli.support.errors import InputError

CHANNELS = ["f_in_N", "f_out_N", "x_out_mm"]


@pytest.fixture(scope="module")
def root(calibrations):
    return calibrations


@pytest.fixture(scope="module")
def changed(root):
    """The two calibrations held against each other."""
    return compare(root / "calibrated-1", root / "calibrated-2")


@pytest.fixture(scope="module")
def on_second(root):
    models = (root / f"calibrated-{seed}" / "model.toml" for seed in (1, 2))
    return compare(*models, on=read_dataset(root / "data-2"))


def copied(root, folder):
    for name in ("data-1", "calibrated-1"):
        shutil.copytree(root / name, folder / name)


def of(it, name):
    return next(p for p in it.pairs if p.name == name).difference


def test_a_known_difference_is_recovered_and_nothing_else(changed):
    friction = of(changed, "friction_coefficient")
    assert friction.low < 0.025 < friction.high
    assert friction.high - friction.low < 0.002
    assert [p.name for p in changed.differing] == ["friction_coefficient"]
    assert {p.name for p in changed.tested} >= {"load_stiffness_N_per_mm", "tendon_stiffness_N"}


def test_swapped_sides_turn_the_signs_and_the_ratios(root, changed, on_second):
    turned = compare(root / "calibrated-2", root / "calibrated-1")
    d, t = (of(it, "friction_coefficient") for it in (changed, turned))
    assert (t.value, t.low, t.high) == pytest.approx((-d.value, -d.high, -d.low))
    assert "larger in B" in findings(changed)[0]
    assert "smaller in B" in findings(turned)[0]
    models = (root / f"calibrated-{seed}" / "model.toml" for seed in (2, 1))
    back = compare(*models, on=read_dataset(root / "data-2"))
    for one, other in zip(on_second.errors, back.errors, strict=True):
        assert one.ratio == pytest.approx(1.0 / other.ratio)
        assert (one.fitted_a, one.fitted_b) == (other.fitted_b, other.fitted_a)
    assert on_second.maps["a"] == back.maps["b"]


def test_the_same_rig_measured_again_claims_nothing(root, tmp_path):
    it = compare(root / "calibrated-1", calibrated(tmp_path, NOMINAL, seed=3))
    assert it.overlap == "none"
    assert len(it.tested) >= 3
    assert it.differing == []
    assert "No value differs" in findings(it)[0]


def test_a_model_against_itself_says_that_the_recordings_are_the_same(root):
    it = compare(root / "calibrated-1", root / "calibrated-1")
    assert it.overlap == "all"
    assert it.tested == []
    assert {p.difference.value for p in it.pairs} == {0.0}
    assert {row.ratio for row in it.errors} == {1.0}
    assert "not independent" in notes(it)[0]


def test_runs_of_the_same_name_that_are_other_recordings_are_not_matched(changed):
    assert changed.shared == []
    assert len(changed.recordings) == 4
    assert all(row.ratio is None for row in changed.errors)
    assert {row.run_a for row in changed.errors} == {"slow", "fast", None}
    assert any("same name" in note and "slow, fast" in note for note in notes(changed))
    own = [p for p in changed.pairs if p.name == "preload_N"]
    assert [p.difference for p in own] == [None] * 4


def test_a_renamed_recording_is_matched(root, tmp_path):
    copied(root, tmp_path)
    for path in (tmp_path / "data-1" / "dataset.toml", tmp_path / "calibrated-1" / "model.toml"):
        path.write_text(path.read_text().replace('"slow"', '"s"').replace("runs.slow", "runs.s"))
    path = tmp_path / "calibrated-1" / "calibration.json"
    content = json.loads(path.read_text())
    content["dataset"]["hashes"] = read_dataset(tmp_path / "data-1").hashes()
    path.write_text(json.dumps(content))
    it = compare(root / "calibrated-1", tmp_path / "calibrated-1")
    assert [both.ids for both in it.shared] == [("slow", "s"), ("fast", "fast")]
    assert {row.ratio for row in it.errors} == {1.0}
    assert ("preload_N", "slow = s") in {(p.name, p.run) for p in it.pairs if p.difference}


def test_on_a_dataset_both_models_are_held_to_the_same_recordings(on_second):
    rows = [r for r in on_second.errors if r.channel == "f_in_N"]
    assert [(r.run_a, r.run_b) for r in rows] == [("slow", "slow"), ("fast", "fast")]
    assert all(r.ratio < 0.2 for r in rows)  # friction off by 20 % against the rig's own
    assert all(r.rmse_b < 2.0 * r.noise for r in rows)
    assert {(r.fitted_a, r.fitted_b) for r in rows} == {(False, True)}
    assert any("favours" in note for note in notes(on_second))


def test_another_recording_of_the_same_name_keeps_its_own_preload(root, tmp_path):
    # The model's own preload of its run `slow` is spoiled: it must not reach another recording.
    content = tomlkit.parse((root / "calibrated-1" / "model.toml").read_text())
    preload = content["runs"]["slow"]["preload_N"]
    content["runs"]["slow"]["preload_N"] = {"value": 100.0 + preload["value"], "unit": "N"}
    spoiled = tmp_path / "model.toml"
    spoiled.write_text(tomlkit.dumps(content))
    whole = root / "calibrated-1" / "model.toml"
    other = compare(whole, spoiled, on=read_dataset(root / "data-2"))
    assert {row.ratio for row in other.errors} == {1.0}
    own = compare(whole, spoiled, on=read_dataset(root / "data-1"))
    slow = [r.ratio for r in own.errors if r.run_a == "slow" and r.channel == "f_out_N"]
    assert slow[0] > 10.0


def test_each_side_is_held_to_its_runs_under_its_own_conditions(root):
    """A recording that both have read is prepared for each, where they state another bend."""
    stated = read_dataset(root / "data-1")
    side, predictions = read_side(root / "calibrated-1"), Predictions()
    for data in (stated, stated.under(total_bend_rad=1.0)):
        bends = {one.run.run.total_bend_rad for one in predictions.of(side, data)}
        assert bends == {run.total_bend_rad for run in data.runs}


def test_two_model_files_alone_give_their_values_and_say_what_gives_more(root):
    it = compare(*(root / f"calibrated-{seed}" / "model.toml" for seed in (1, 2)))
    assert [p.name for p in it.differing] == ["friction_coefficient"]
    assert (it.errors, it.maps) == ([], {})
    assert "--on DATASET" in notes(it)[-1]


def test_maps_share_their_bins_and_show_where_the_error_is(on_second):
    a, b = on_second.maps["a"], on_second.maps["b"]
    assert set(a) == set(b) == set(CHANNELS)
    pulling = {one.label: one.mean for one in a["f_in_N"]["direction"]}
    assert pulling["pulling"] > 5.0  # more friction than A knows
    assert pulling["releasing"] < -5.0
    assert all(abs(one.mean) < 1.0 for one in b["f_in_N"]["speed_mm_per_s"])
    edges = [[(one.low, one.high) for one in side["f_in_N"]["time_s"]] for side in (a, b)]
    assert edges[0] == edges[1]


def test_simulations_are_held_to_their_own_series(root, tmp_path):
    data = read_dataset(root / "data-2")
    for seed in (1, 2):
        model = root / f"calibrated-{seed}" / "model.toml"
        simulate(data, model=model, out=tmp_path / f"s{seed}")
    it = compare(tmp_path / "s1", tmp_path / "s2")
    assert it.pairs == []
    for side, name in (("s1", "rmse_a"), ("s2", "rmse_b")):
        said = json.loads((tmp_path / side / "simulation.json").read_text())["runs"]
        for row in it.errors:
            known = said[row.run_a]["channels"][row.channel]["rmse"]
            assert getattr(row, name) == pytest.approx(known, rel=1e-9)


def test_everything_that_is_printed_is_in_the_json(changed, on_second):
    for it in (changed, on_second):
        content = record_of(it)
        assert content.format == 1
        assert content.stage == "compare"
        printed = {title: rows for title, _, rows in tables(content)}
        assert len(printed["parameters"]) == len(content.parameters)
        assert len(printed["errors"]) == len(content.errors)
        friction = next(p for p in content.parameters if p.name == "friction_coefficient")
        assert friction.difference.excludes_zero is True
        assert friction.a.value == pytest.approx(0.125, abs=1e-3)
        assert friction.b.value == pytest.approx(0.150, abs=1e-3)


def test_a_dataset_that_is_gone_or_has_changed_leaves_the_values(root, tmp_path):
    copied(root, tmp_path)
    with (tmp_path / "data-1" / "dataset.toml").open("a") as stream:
        stream.write("\n# changed\n")
    says(root, tmp_path, "has changed")
    (tmp_path / "data-1" / "dataset.toml").write_text("what?")
    says(root, tmp_path, "is not TOML")
    shutil.rmtree(tmp_path / "data-1")
    says(root, tmp_path, "no longer at")


def says(root, folder, told):
    it = compare(root / "calibrated-2", folder / "calibrated-1")
    assert [p.name for p in it.differing] == ["friction_coefficient"]
    assert any(told in note for note in notes(it))


def test_what_cannot_be_compared_is_refused(root, tmp_path):
    model = root / "calibrated-1" / "model.toml"
    simulate(root / "data-1", model=model, out=tmp_path / "s")
    (tmp_path / "empty").mkdir()
    shutil.copytree(root / "calibrated-1", tmp_path / "two")
    shutil.copy(tmp_path / "s" / "simulation.json", tmp_path / "two")
    data = read_dataset(root / "data-1")
    for a, b, more, said in (
        (model, tmp_path / "empty", {}, "calibration.json, diagnosis.json"),
        (model, tmp_path / "none.toml", {}, "nothing that can be compared"),
        (model, root / "data-1" / "dataset.toml", {}, "dataset.toml"),
        (model, tmp_path / "two", {}, "calibration.json and simulation.json"),
        (model, tmp_path / "s", {}, "nothing to compare"),
        (tmp_path / "s", tmp_path / "s", {"on": data}, "does not hold its model"),
    ):
        with pytest.raises(InputError, match=said):
            compare(a, b, **more)


def test_runs_of_one_dataset_that_were_fitted_apart_are_independent(root, tmp_path):
    data = read_dataset(root / "data-1")
    for run in ("slow", "fast"):
        calibrate(data.only([run]), out=tmp_path / run)
    for pair in (("slow", "fast"), ("slow/model.toml", "fast/model.toml")):
        it = compare(*(tmp_path / name for name in pair))
        assert it.overlap == "none"
        assert it.tested
        assert it.differing == []


def test_a_series_of_another_length_is_refused(root, tmp_path):
    data = read_dataset(root / "data-1")
    simulate(data, model=root / "calibrated-1" / "model.toml", out=tmp_path / "s")
    runs = tmp_path / "s" / "runs"
    shutil.copy(runs / "fast.parquet", runs / "slow.parquet")
    with pytest.raises(InputError, match="rows"):
        compare(tmp_path / "s", tmp_path / "s")


@pytest.mark.parametrize(
    ("ratios", "said"),
    [
        ((0.5, 0.8), "in f_in_N B is better (RMSE of B 0.5 to 0.8 times that of A)"),
        ((1.2, 1.2), "in f_in_N A is better (RMSE of B 1.2 times that of A)"),
        ((0.5, 1.2), "in f_in_N neither is better in all"),
        ((0.995, 1.005), "in f_in_N they are alike"),
    ],
)
def test_which_is_better_is_said_of_runs_that_no_fit_has_seen(on_second, ratios, said):
    row = next(r for r in on_second.errors if r.channel == "f_in_N")
    held_out = {"fitted_a": False, "fitted_b": False}
    told = [held_out | {"run_b": f"r{n}", "ratio": ratio} for n, ratio in enumerate(ratios)]
    it = replace(on_second, errors=[row.model_copy(update=one) for one in told])
    assert findings(it)[0].startswith("On 2 held-out runs")
    assert said in findings(it)[0]
    assert not any("predicts better" in note for note in notes(it))
    assert any("predicts better" in note for note in notes(on_second))


def test_doubts_are_said(on_second):
    doubtful = replace(on_second.b, dynamics="lugre", not_converged="it wandered.")
    said = " ".join(notes(replace(on_second, b=doubtful)))
    assert "two laws of motion: A slip, B lugre" in said
    assert "fit of B did not converge (it wandered)" in said
    assert "converge" not in " ".join(notes(on_second))


def test_a_model_without_its_recordings_makes_no_claim(root, tmp_path):
    text = (root / "calibrated-2" / "model.toml").read_text()
    bare = tmp_path / "bare.toml"
    start, end = text.index("[dataset]"), text.index("[parameters")
    bare.write_text(text[:start] + text[end:])
    it = compare(root / "calibrated-1", bare)
    assert it.overlap == "unknown"
    assert it.tested == []
    assert any("B does not say" in note for note in notes(it))
    assert np.isfinite(of(it, "friction_coefficient").value)
