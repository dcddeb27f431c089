"""What `tsas simulate` writes and says, once in a process of its own."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tests.commands.documented import documented
from tests.refusals import refusal
from tests.rigs import dataset_of, recorded
from tsas_cli.identification.model_file import stated_model
from tsas_studies.challenge.rig.tendon import Rig

TRUE = Rig(friction_coefficient=0.16, cells=60)
MODEL = """
format = 1
[parameters]
friction_coefficient = { value = 0.16, unit = "1" }
tendon_stiffness_N = { value = 67858.4, unit = "N" }
load_stiffness_N_per_mm = { value = 1.579, unit = "N/mm" }
"""


@pytest.fixture
def folder(tmp_path):
    return dataset_of(TRUE, tmp_path / "dataset", a=recorded(TRUE, 200.0))


@pytest.fixture
def model(tmp_path):
    """Return a function that writes the true model, with more text behind it."""

    def write(more=""):
        (tmp_path / "m.toml").write_text(MODEL + more, encoding="utf-8")
        return tmp_path / "m.toml"

    return write


def test_the_true_model_is_at_the_noise_and_the_data_sheet_is_not(folder, model, tmp_path):
    """RMSE as it is written, and as it follows from the written samples."""
    rmse = {}
    for name, given in {"true": model(), "sheet": None}.items():
        out = tmp_path / name
        channels = tsas.simulate(folder, model=given, out=out).summary["runs"]["a"]["channels"]
        measured = pq.read_table(folder / "runs" / "a.parquet").to_pandas()
        simulated = pq.read_table(out / "runs" / "a.parquet").to_pandas()
        for channel, result in channels.items():
            error = measured[channel] - simulated[channel]
            assert result["rmse"] == pytest.approx(float(np.sqrt(np.mean(error**2))))
        rmse[name] = channels
    assert rmse["true"]["f_out_N"]["rmse"] < 1.1 * rmse["true"]["f_out_N"]["noise"]
    assert rmse["true"]["f_in_N"]["rmse"] < 3.0 * rmse["true"]["f_in_N"]["noise"]
    assert rmse["sheet"]["f_in_N"]["rmse"] > 10.0 * rmse["true"]["f_in_N"]["rmse"]


def test_the_preload_of_a_run_goes_with_its_recording_not_with_its_name(folder, model, tmp_path):
    source = tsas.read(folder)
    given = model(
        '[runs.a]\npreload_N = { value = 24.0, unit = "N" }\n'
        f'[dataset]\nname = "d"\n[dataset.hashes]\n"runs/a.parquet" = "{source.runs[0].sha256}"\n'
    )
    first, another = recorded(TRUE, 200.0), recorded(TRUE, 200.0, seed=3)
    other = tsas.read(dataset_of(TRUE, tmp_path / "other", a=another, q=first))
    tsas.simulate(other, model=given, out=tmp_path / "out")
    used = tsas.read_model(tmp_path / "out" / "model.toml")
    assert used.value("preload_N", "q") == 24.0
    assert used.value("preload_N", "a") is None
    assert used.rig(other.runs[0]).preload_N == other.runs[0].preload_N
    stated = stated_model(other.manifest, given)
    assert stated.value("preload_N", "q") == 24.0
    assert stated.value("preload_N", "a") == other.runs[0].preload_N != 24.0


def test_it_writes_what_is_documented_and_agrees_with_the_fit(done, folder, tmp_path):
    calibrated = tsas.calibrate(folder, out=tmp_path / "c").summary["channels"]["a"]
    call = ("--model", tmp_path / "c" / "model.toml", "--out", tmp_path / "out", "--json")
    summary = json.loads(done("simulate", folder, *call))
    written = (tmp_path / "out" / "simulation.json").read_text(encoding="utf-8")
    assert summary == json.loads(written)
    assert set(summary) == documented("simulation.json")
    assert set(summary["runs"]["a"]) == {
        *("solver", "conditioning", "start", "samples", "slack_samples"),
        *("unconverged_samples", "notes", "channels"),
    }
    channels = summary["runs"]["a"]["channels"]
    assert set(channels["f_in_N"]) == {"rmse", "noise", "samples", "unit"}
    for channel, result in calibrated.items():
        assert channels[channel]["rmse"] == pytest.approx(result["rmse"])
    table = pq.read_table(tmp_path / "out" / "runs" / "a.parquet")
    assert set(table.column_names) == {"time_s", "x_in_mm", "f_in_N", "f_out_N", "x_out_mm"}
    assert table.schema.field("f_in_N").metadata[b"unit"] == b"N"


def test_gaps_of_the_drive_are_null(tmp_path):
    columns = {name: v.copy() for name, v in recorded(TRUE, 200.0).items()}
    columns["x_in_mm"][500:600] = np.nan
    folder = dataset_of(TRUE, tmp_path / "d", a=columns)
    result = tsas.simulate(folder, out=tmp_path / "out")
    table = pq.read_table(tmp_path / "out" / "runs" / "a.parquet")
    assert table.column("f_in_N").null_count == 100
    channel = result.summary["runs"]["a"]["channels"]["f_in_N"]
    assert channel["samples"] == columns["time_s"].size - 100


@pytest.mark.parametrize("load", ["force", "displacement"])
def test_the_static_model_knows_springs_only(tmp_path, load):
    folder = dataset_of(TRUE, tmp_path / "d", told={"load": load}, a=recorded(TRUE, 200.0))
    assert refusal(tsas.simulate, folder, dynamics="static", out=tmp_path / "out") == (
        "run a: the static model is valid for a spring load and a drive by displacement "
        "only; use --dynamics slip"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("dynamics", ["static", "lugre"])
def test_only_the_distributed_model_has_a_second_tendon(refused, folder, model, tmp_path, dynamics):
    pair = model('[effects.antagonist.preload_N]\nvalue = 20.0\nunit = "N"\n')
    call = ("--model", pair, "--dynamics", dynamics, "--out", tmp_path / "out")
    assert refused("simulate", folder, *call) == (
        "tsas: run a: antagonist is in the model, which the static and the dynamic model do not "
        "have; use --dynamics slip\n"
    )


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"model": "none.toml"}, "cannot be read"),
        ({"nodes": 1}, "expected 2 to 1000"),
        ({"nodes": 1001, "dynamics": "lugre"}, "expected 2 to 1000"),
        ({"nodes": 50, "dynamics": "static"}, "the static model has no nodes"),
    ],
)
def test_what_cannot_be_simulated_is_said_and_nothing_is_written(folder, tmp_path, options, says):
    assert says in refusal(tsas.simulate, folder, out=tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_run_that_was_not_fitted_is_predicted_once_its_own_zeros_are_known(model, tmp_path):
    """A shifted sensor ruins the prediction; friction stays what the model says."""
    whole = recorded(TRUE, 200.0)
    shifted = whole | {"x_in_mm": whole["x_in_mm"] + 0.4}
    folder = dataset_of(TRUE, tmp_path / "d", a=whole, b=shifted)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(MODEL.replace("value = 0.16", "value = 0.15"), encoding="utf-8")
    residuals, cases = {}, {"as it is": (model(), False), "own": (model(), True)}
    cases |= {
        "wrong": (wrong, True),
        "again": (tmp_path / "own", False),
    }  # the model as it was used
    for name, (file, fit_own) in cases.items():
        out = tmp_path / name
        result = tsas.simulate(folder, model=file, fit_own=fit_own, runs=["b"], out=out)
        assert list(result.summary["runs"]) == result.summary["chosen"] == ["b"]
        residuals[name] = result.summary["runs"]["b"]["channels"]["f_in_N"]
    assert residuals["own"]["rmse"] < 2.0 * residuals["own"]["noise"]
    assert residuals["as it is"]["rmse"] > 5.0 * residuals["own"]["rmse"]
    assert residuals["wrong"]["rmse"] > 3.0 * residuals["own"]["rmse"]
    assert residuals["again"] == residuals["own"]


def test_the_dynamic_model_says_whose_bristles_it_takes(folder):
    result = tsas.simulate(folder, dynamics="lugre")
    assert "LuGre chain, 50 lumps" in repr(result)
    (note,) = (line for line in result.sentences() if line.startswith("- "))
    assert "Table 1" in note


BRISTLES = """[bristles]
stiffness_N_per_mm = {{ value = 5000.0, unit = "N/mm" }}
damping_N_s_per_mm = {{ value = {}, unit = "N s/mm" }}
"""
FALLING = """[effects.stribeck_friction]
excess = { value = 0.15, unit = "1" }
velocity_mm_per_s = { value = 3.0, unit = "mm/s" }
"""
UNSTABLE = ("sliding is unstable in a dead band", "79.7 times critical")
STICKS = ("sticks and slips", "friction falls with speed by more than the damping")


@pytest.mark.parametrize(
    ("more", "words", "said"),
    [
        (BRISTLES.format(15.8), UNSTABLE, True),
        (BRISTLES.format(0.2), UNSTABLE, False),
        (FALLING, STICKS, True),
    ],
)
def test_the_dynamic_model_says_where_sliding_is_unstable(folder, model, more, words, said):
    printed = repr(tsas.simulate(folder, model=model(more), dynamics="lugre"))
    assert [word in printed for word in words] == [said] * 2


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
def test_the_nodes_are_as_many_as_asked_for(folder, model, dynamics):
    summary = tsas.simulate(folder, model=model(), dynamics=dynamics, nodes=5).summary
    assert summary["nodes"] == 5
    assert " 5 " in summary["runs"]["a"]["solver"]
