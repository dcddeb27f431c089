"""What `tsas simulate` writes and says, once in a process of its own."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tests.commands.documented import documented
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

TRUE = Rig(friction_coefficient=0.16, cells=60)


@pytest.fixture(scope="module")
def recorded():
    return record(TRUE, sine(rate_Hz=400.0), sensors=Sensors(rate_Hz=200.0))


@pytest.fixture
def folder(tmp_path, recorded):
    return write_dataset(tmp_path / "dataset", [Run("a", recorded, conditions(TRUE))])


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text(
        "format = 1\n[parameters.friction_coefficient]\nvalue = 0.16\nunit = '1'\n"
        "[parameters.tendon_stiffness_N]\nvalue = 67858.4\nunit = 'N'\n"
        "[parameters.load_stiffness_N_per_mm]\nvalue = 1.579\nunit = 'N/mm'\n",
        encoding="utf-8",
    )
    return path


def test_the_true_model_is_at_the_noise_and_the_data_sheet_is_not(folder, model, tmp_path):
    """RMSE as it is written, and as it follows from the written samples."""
    rmse = {}
    for name, given in {"true": model, "sheet": None}.items():
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


def test_it_writes_what_is_documented_and_agrees_with_the_fit(strict, folder, tmp_path):
    calibrated = tsas.calibrate(folder, out=tmp_path / "c").summary["channels"]["a"]
    call = ("--model", tmp_path / "c" / "model.toml", "--out", tmp_path / "out", "--json")
    done = strict("simulate", folder, *call)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
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


def test_gaps_of_the_drive_are_null(recorded, tmp_path):
    columns = {name: v.copy() for name, v in recorded.items()}
    columns["x_in_mm"][500:600] = np.nan
    folder = write_dataset(tmp_path / "d", [Run("a", columns, conditions(TRUE))])
    result = tsas.simulate(folder, out=tmp_path / "out")
    table = pq.read_table(tmp_path / "out" / "runs" / "a.parquet")
    assert table.column("f_in_N").null_count == 100
    channel = result.summary["runs"]["a"]["channels"]["f_in_N"]
    assert channel["samples"] == recorded["time_s"].size - 100


@pytest.mark.parametrize("load", ["force", "displacement"])
def test_the_static_model_knows_springs_only(recorded, tmp_path, load):
    given = conditions(TRUE) | {"load": load}
    folder = write_dataset(tmp_path / "d", [Run("a", recorded, given)])
    with pytest.raises(tsas.InputError) as refused:
        tsas.simulate(folder, dynamics="static", out=tmp_path / "out")
    assert refused.value.line() == (
        "run a: the static model is valid for a spring load and a drive by displacement "
        "only; use --dynamics slip"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("dynamics", ["static", "lugre"])
def test_only_the_distributed_model_has_a_second_tendon(
    strict, recorded, model, tmp_path, dynamics
):
    folder = write_dataset(tmp_path / "d", [Run("a", recorded, conditions(TRUE))])
    pair = tmp_path / "pair.toml"
    line = '\n[effects.antagonist.preload_N]\nvalue = 20.0\nunit = "N"\n'
    pair.write_text(model.read_text() + line)
    out = tmp_path / "out"
    done = strict("simulate", folder, "--model", pair, "--dynamics", dynamics, "--out", out)
    assert done.returncode == 2
    assert done.stderr == (
        "tsas: run a: antagonist is in the model, which the static and the dynamic model do not "
        "have; use --dynamics slip\n"
    )


@pytest.mark.parametrize(
    ("model", "options", "says"),
    [
        (None, {"model": "none.toml"}, "cannot be read"),
        ("format = 3\n", {}, "format: input should be 1"),
        ("format = 1\n[parameters.preload]\nvalue = 1\nunit = 'N'\n", {}, "did you mean preload_N"),
        (None, {"nodes": 1}, "expected 2 to 1000"),
        (None, {"nodes": 1001, "dynamics": "lugre"}, "expected 2 to 1000"),
        (None, {"nodes": 50, "dynamics": "static"}, "the static model has no nodes"),
    ],
)
def test_what_cannot_be_simulated_is_said_and_nothing_is_written(
    folder, tmp_path, model, options, says
):
    if model:
        (tmp_path / "wrong.toml").write_text(model, encoding="utf-8")
        options = {"model": tmp_path / "wrong.toml"}
    with pytest.raises(tsas.InputError, match=says):
        tsas.simulate(folder, out=tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_run_that_was_not_fitted_is_predicted_once_its_own_zeros_are_known(
    recorded, model, tmp_path
):
    """A shifted sensor ruins the prediction; friction stays what the model says."""
    shifted = recorded | {"x_in_mm": recorded["x_in_mm"] + 0.4}
    folder = write_dataset(
        tmp_path / "d",
        [Run("a", recorded, conditions(TRUE)), Run("b", shifted, conditions(TRUE))],
    )
    wrong = model.read_text(encoding="utf-8").replace("value = 0.16", "value = 0.15")
    (tmp_path / "wrong.toml").write_text(wrong, encoding="utf-8")
    residuals = {}
    for name, file, fit_own in (
        ("as it is", model, False),
        ("own", model, True),
        ("wrong", tmp_path / "wrong.toml", True),
        ("again", tmp_path / "own", False),  # with the model as it was used
    ):
        out = tmp_path / name
        result = tsas.simulate(folder, model=file, fit_own=fit_own, runs=["b"], out=out)
        assert list(result.summary["runs"]) == result.summary["chosen"] == ["b"]
        residuals[name] = result.summary["runs"]["b"]["channels"]["f_in_N"]
    assert residuals["own"]["rmse"] < 2.0 * residuals["own"]["noise"]
    assert residuals["as it is"]["rmse"] > 5.0 * residuals["own"]["rmse"]
    assert residuals["wrong"]["rmse"] > 3.0 * residuals["own"]["rmse"]
    assert residuals["again"] == residuals["own"]


BRISTLES = """
[bristles]
stiffness_N_per_mm = {{ value = {stiffness}, unit = "N/mm" }}
damping_N_s_per_mm = {{ value = {damping}, unit = "N s/mm" }}
"""


def with_bristles(path, **values):
    text = 'format = 1\nkind = "model"\n' + BRISTLES.format(**values)
    path.write_text(text, encoding="utf-8")
    return path


def test_the_dynamic_model_says_whose_bristles_it_takes(folder):
    result = tsas.simulate(folder, dynamics="lugre")
    assert "LuGre chain, 50 lumps" in repr(result)
    (note,) = (line for line in result.sentences() if line.startswith("- "))
    assert "Table 1" in note


def test_the_dynamic_model_says_where_sliding_is_unstable(folder, tmp_path):
    for damping, unstable in ((15.8, True), (0.2, False)):
        model = with_bristles(tmp_path / "model.toml", stiffness=5000.0, damping=damping)
        said = repr(tsas.simulate(folder, model=model, dynamics="lugre"))
        assert ("sliding is unstable in a dead band" in said) == unstable
        assert ("79.7 times critical" in said) == unstable


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
def test_more_nodes_are_nearer_to_many(folder, model, dynamics):
    f_in = {}
    for nodes in (5, 20, 200):
        result = tsas.simulate(folder, model=model, dynamics=dynamics, nodes=nodes)
        assert result.summary["nodes"] == nodes
        assert f" {nodes} " in result.summary["runs"]["a"]["solver"]
        f_in[nodes] = result["a"].columns["f_in_N"]
    off = {nodes: np.sqrt(np.mean((f_in[nodes] - f_in[200]) ** 2)) for nodes in (5, 20)}
    assert off[5] > 4.0 * off[20] > 0.0


def test_a_tendon_that_sticks_and_slips_is_reported_to(folder, model):
    text = model.read_text(encoding="utf-8")
    text += (
        "[effects.stribeck_friction.excess]\nvalue = 0.15\nunit = '1'\n"
        "[effects.stribeck_friction.velocity_mm_per_s]\nvalue = 3.0\nunit = 'mm/s'\n"
    )
    model.write_text(text, encoding="utf-8")
    said = repr(tsas.simulate(folder, model=model, dynamics="lugre"))
    assert "sticks and slips" in said
    assert "friction falls with speed by more than the damping" in said
