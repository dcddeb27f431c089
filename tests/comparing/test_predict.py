"""What models predict of recordings that they were not fitted to."""

import json
import shutil
from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest
import tomlkit

import tsas_cli as tsas
from tests.comparing.made import NOMINAL, ROUGH, recorded
from tests.counted import Counted
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.recordings.session import Session
from tsas_cli.recordings.writing import columns_of

CHANNELS = ["f_in_N", "f_out_N", "x_out_mm"]


@pytest.fixture(scope="module")
def root(calibrations):
    """Beside them recordings of other rigs."""
    recorded(calibrations / "rough", ROUGH, seed=4)
    recorded(calibrations / "bent", replace(NOMINAL, total_bend_rad=1.5), seed=5)
    return calibrations


@pytest.fixture(scope="module")
def rough(root):
    models = [root / "calibrated-1", root / "calibrated-2" / "model.toml"]
    return tsas.predict(models, root / "rough", out=root / "out", step=(step := Counted())), step


def copied(dataset, folder, old, new):
    """Copy a dataset with another text in its manifest."""
    shutil.copytree(dataset, folder / "data")
    path = folder / "data" / "dataset.toml"
    path.write_text(path.read_text().replace(old, new))
    return folder / "data"


def rows(result, **wanted):
    return [
        row
        for row in result.record.channels
        if all(getattr(row, name) == value for name, value in wanted.items())
    ]


def verdicts(result):
    return [row.verdict for row in result.record.ranges]


def test_the_model_of_the_same_rig_predicts_and_the_other_one_does_not(rough):
    result, step = rough
    assert step.all_of(least=4)  # two runs by two models
    assert [row.channel for row in rows(result, run="slow", model="A")] == CHANNELS
    for row in rows(result, channel="f_in_N", model="A"):
        assert row.normalised_residual > 10.0
        assert row.ratio == 1.0
    for row in rows(result, model="B"):
        assert row.normalised_residual < 1.5
        assert row.seen is False
    f_in, *_ = result.record.findings
    assert f_in.startswith("f_in_N: B predicts best")
    assert "over 2 runs that no fit has seen (A " in f_in


def test_models_in_another_order_are_held_against_the_other_one(root, rough):
    models = [root / "calibrated-2", root / "calibrated-1"]
    turned = tsas.predict(models, root / "rough", runs=["slow"])
    ours, (a, b) = rows(turned, model="B"), (rows(rough[0], model=m, run="slow") for m in "AB")
    assert [one.rmse for one in ours] == pytest.approx([other.rmse for other in a])
    assert [one.ratio for one in ours] == pytest.approx([1.0 / other.ratio for other in b])
    assert turned.record.findings[0].startswith("f_in_N: A predicts best")


def test_every_figure_is_that_of_its_definition(root, rough):
    data, written = tsas.read(root / "rough"), root / "out" / "runs"
    for row in rough[0].record.channels:
        measured = data[row.run].columns[row.channel]
        quantity, unit = row.channel.rsplit("_", 1)
        name = f"{quantity}_{row.model}_{unit}"
        simulated = columns_of(written / f"{row.run}.parquet", [name])[name]
        assert row.rmse == pytest.approx(np.sqrt(np.mean((measured - simulated) ** 2)))
        assert row.share_percent == pytest.approx(100.0 * row.rmse / np.ptp(measured))
        assert row.normalised_residual == pytest.approx(row.rmse / row.noise)
        assert row.repeatability == pytest.approx(row.noise, rel=0.2)


def test_the_errors_are_those_of_simulate(root, rough):
    model = root / "calibrated-1" / "model.toml"
    simulated = tsas.simulate(root / "rough", model=model, fit_own=True).record.runs
    for row in rows(rough[0], model="A"):
        assert row.rmse == pytest.approx(simulated[row.run].channels[row.channel].rmse)


def test_a_recording_that_the_fit_has_seen_is_no_prediction_under_any_name(root, tmp_path):
    data = copied(root / "data-1", tmp_path, '"slow"', '"s"')
    result = tsas.predict([root / "calibrated-1", root / "calibrated-2"], data)
    assert {(row.run, row.model): row.seen for row in result.record.channels} == {
        ("s", "A"): True, ("s", "B"): False, ("fast", "A"): True, ("fast", "B"): False,
    }  # fmt: skip
    assert list(result.record.findings[:2]) == [
        "A is fitted to s and fast, which is no prediction.",
        "No run is new to every model.",
    ]
    assert [r.verdict for r in result.record.ranges if r.model == "A"] == ["inside"] * 2
    (span,) = result.record.ranges[1].outside  # B was fitted to a rig with more friction
    assert span.quantity == "f_in_span_N"


def test_only_the_preload_and_the_zeros_of_a_run_are_fitted_to_it(root, tmp_path):
    data = copied(root / "again", tmp_path, "preload_N = 25.0", "preload_N = 23.0")
    own, as_is = (
        tsas.predict(root / "calibrated-1", data, runs=["slow"], fit_own=fit_own)
        for fit_own in (True, False)
    )
    assert rows(own, channel="f_out_N")[0].normalised_residual < 1.2
    assert rows(as_is, channel="f_out_N")[0].rmse == pytest.approx(2.0, abs=0.2)
    assert "Nothing is fitted to these runs." in as_is.record.notes
    assert as_is.record.own_values_fitted is False
    assert verdicts(own) == ["inside"]  # 8 % of the preload


def test_another_bend_is_outside_the_range_and_the_same_rig_is_inside(root):
    model = root / "calibrated-1"
    again = tsas.predict(model, root / "again")
    assert verdicts(again) == ["inside", "inside"]
    assert "Every run lies in the model's range (A)." in again.record.findings
    bent = tsas.predict(model, root / "bent")
    assert verdicts(bent) == ["outside", "outside"]
    (bend, *_) = [one for one in bent.record.ranges[0].outside if one.quantity == "total_bend_rad"]
    assert bend.here == (1.5, 1.5)
    assert bend.fitted == pytest.approx((np.pi, np.pi))
    assert any("(A): slow and fast, by total_bend_rad" in said for said in bent.record.findings)


def test_what_drifts_over_the_session_goes_on_in_recordings_of_the_same_session(root, tmp_path):
    """Of runs that begin later by 1000 s, friction of 0.1 that grows by 1e-4/s is one of 0.11."""
    began = "started = 2026-05-04T12:16:40"
    data = copied(root / "again", tmp_path, "[[run]]", f"[[run]]\n{began}")
    noon = datetime(2026, 5, 4, 12)  # noqa: DTZ001 # the clock of a rig has no zone
    friction = Estimate("friction_coefficient", 0.1, "1", "given")
    drift = Estimate("friction_drift.session_rate_per_s", 1e-4, "1/s", "given")
    of_day, worn, other = (
        Model((friction, drift), Session(noon, noon + timedelta(minutes=10))),
        Model((replace(friction, value=0.11),)),
        Model((friction, drift)),
    )
    for models, same in (([of_day, worn], True), ([other, worn], False)):
        result = tsas.predict(models, data, runs=["slow"])
        rmse = [rows(result, model=m, channel="f_out_N")[0].rmse for m in "AB"]
        assert (rmse[0] == pytest.approx(rmse[1], rel=1e-3)) is same


def test_a_model_that_does_not_say_its_range_leaves_it_open(root, tmp_path):
    content = tomlkit.parse((root / "calibrated-1" / "model.toml").read_text())
    del content["fitted_to"]
    (tmp_path / "old.toml").write_text(tomlkit.dumps(content))
    old = tsas.predict(tmp_path / "old.toml", root / "again", runs=["slow"])
    assert verdicts(old) == ["unknown"]
    assert "It is not known what ranges the model was fitted to (A)." in old.record.findings
    memory = tsas.predict(tsas.read_model(tmp_path / "old.toml"), root / "again", runs=["slow"])
    assert {row.seen for row in memory.record.channels} == {None}
    assert any("may have seen these runs" in note for note in memory.record.notes)
    assert [one.file for one in memory.record.models] == ["in memory"]
    for one, other in zip(old.record.channels, memory.record.channels, strict=True):
        assert one.rmse == pytest.approx(other.rmse, rel=1e-4)


def test_what_the_model_s_recordings_do_not_state_is_not_compared(root, tmp_path):
    data = copied(root / "again", tmp_path, "preload_N =", "wrist_deg = 30.0\npreload_N =")
    result = tsas.predict(root / "calibrated-1", data, runs=["slow"])
    assert verdicts(result) == ["inside"]
    assert result.record.ranges[0].not_stated == ("wrist_deg",)
    assert any("not compared: wrist_deg" in note for note in result.record.notes)


def test_models_that_predict_alike_are_said_to(root):
    result = tsas.predict([root / "calibrated-1"] * 2, root / "again", runs=["slow"])
    assert result.record.findings[0].startswith("f_in_N: A and B predict alike, RMSE ")


def test_what_is_written_is_the_summary_and_every_checksum_fits(root, rough):
    result, _ = rough
    content = json.loads((root / "out" / "predict.json").read_text())
    assert content == json.loads(json.dumps(result.summary))
    (changed,) = {f.state for f in tsas.verify(root / "out").files}
    assert changed == "fits"
    by = {f.file for f in tsas.verify(root / "out").files}
    assert any(file.endswith("calibrated-2/model.toml") for file in by)


def test_what_cannot_predict_is_refused(root, tmp_path):
    simulated = tmp_path / "s"
    tsas.simulate(root / "again", runs=["slow"], out=simulated)
    (simulated / "model.toml").rename(tmp_path / "model.toml")
    model = root / "calibrated-1"
    for models, said in (
        (simulated, "does not hold its model"),
        ([], "no folder or file is named"),
        ([model] * 27, "27 models"),
        (root / "again", "nothing that can be compared is here"),
        ([None], "of type NoneType"),
    ):
        with pytest.raises(tsas.InputError, match=said):
            tsas.predict(models, root / "again", out=tmp_path / "o")
    with pytest.raises(tsas.InputError, match="is an input"):
        tsas.predict(model, root / "again", out=model, force=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["model.toml", "s"]
