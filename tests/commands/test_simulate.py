"""`tsas simulate` in a process of its own, with every warning an error."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

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


def test_the_true_model_is_at_the_noise_and_the_data_sheet_is_not(strict, folder, model, tmp_path):
    """RMSE as it is written, and as it follows from the written samples."""
    rmse = {}
    for name, options in {"true": ("--model", model), "sheet": ()}.items():
        out = tmp_path / name
        done = strict("simulate", folder, *options, "--out", out, "--json")
        assert (done.returncode, done.stderr) == (0, "")
        summary = json.loads(done.stdout)
        assert summary == json.loads((out / "simulation.json").read_text(encoding="utf-8"))
        measured = pq.read_table(folder / "runs" / "a.parquet").to_pandas()
        simulated = pq.read_table(out / "runs" / "a.parquet").to_pandas()
        for channel, result in summary["runs"]["a"]["channels"].items():
            error = measured[channel] - simulated[channel]
            assert result["rmse"] == pytest.approx(float(np.sqrt(np.mean(error**2))))
        rmse[name] = summary["runs"]["a"]["channels"]
    assert rmse["true"]["f_out_N"]["rmse"] < 1.1 * rmse["true"]["f_out_N"]["noise"]
    assert rmse["true"]["f_in_N"]["rmse"] < 3.0 * rmse["true"]["f_in_N"]["noise"]
    assert rmse["sheet"]["f_in_N"]["rmse"] > 10.0 * rmse["true"]["f_in_N"]["rmse"]


def test_it_writes_what_is_documented(strict, folder, tmp_path):
    done = strict("simulate", folder, "--out", tmp_path / "out", "--json")
    summary = json.loads(done.stdout)
    assert set(summary) == documented("simulation.json")
    assert set(summary["runs"]["a"]) == {
        *("solver", "conditioning", "start", "samples", "slack_samples"),
        *("unconverged_samples", "notes", "channels"),
    }
    assert set(summary["runs"]["a"]["channels"]["f_in_N"]) == {"rmse", "noise", "samples", "unit"}
    table = pq.read_table(tmp_path / "out" / "runs" / "a.parquet")
    assert set(table.column_names) == {"time_s", "x_in_mm", "f_in_N", "f_out_N", "x_out_mm"}
    assert table.schema.field("f_in_N").metadata[b"unit"] == b"N"


def test_gaps_of_the_drive_are_null(strict, recorded, tmp_path):
    columns = {name: v.copy() for name, v in recorded.items()}
    columns["x_in_mm"][500:600] = np.nan
    folder = write_dataset(tmp_path / "d", [Run("a", columns, conditions(TRUE))])
    done = strict("simulate", folder, "--out", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    table = pq.read_table(tmp_path / "out" / "runs" / "a.parquet")
    assert table.column("f_in_N").null_count == 100
    channel = json.loads(done.stdout)["runs"]["a"]["channels"]["f_in_N"]
    assert channel["samples"] == recorded["time_s"].size - 100


def test_calibrate_and_simulate_agree(strict, folder, tmp_path):
    done = strict("calibrate", folder, "--out", tmp_path / "c", "--json")
    calibrated = json.loads(done.stdout)["channels"]["a"]
    done = strict(
        "simulate",
        folder,
        "--model",
        tmp_path / "c" / "model.toml",
        "--out",
        tmp_path / "s",
        "--json",
    )
    simulated = json.loads(done.stdout)["runs"]["a"]["channels"]
    for channel, result in calibrated.items():
        assert simulated[channel]["rmse"] == pytest.approx(result["rmse"])


def test_the_static_model_is_another_one(strict, folder, model, tmp_path):
    """It crosses the dead band on a straight line and is further from the recording there."""
    found = {}
    for dynamics in ("static", "slip"):
        options = ("--model", model, "--dynamics", dynamics, "--json")
        done = strict("simulate", folder, *options, "--out", tmp_path / dynamics)
        assert (done.returncode, done.stderr) == (0, "")
        found[dynamics] = json.loads(done.stdout)["runs"]["a"]["channels"]["f_in_N"]["rmse"]
    assert found["static"] > 2.0 * found["slip"]


@pytest.mark.parametrize("load", ["force", "displacement"])
def test_the_static_model_knows_springs_only(strict, recorded, tmp_path, load):
    given = conditions(TRUE) | {"load": load}
    folder = write_dataset(tmp_path / "d", [Run("a", recorded, given)])
    done = strict("simulate", folder, "--dynamics", "static", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr == (
        "tsas: run a: the static model is valid for a spring load and a drive by displacement "
        "only; use --dynamics slip\n"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "cannot be read"),
        ("format = 3\n", "format: input should be 1"),
        ("format = 1\n[parameters.preload]\nvalue = 1\nunit = 'N'\n", "did you mean preload_N"),
    ],
)
def test_a_wrong_model_is_one_line(strict, folder, tmp_path, text, says):
    path = tmp_path / "wrong.toml"
    if text:
        path.write_text(text, encoding="utf-8")
    done = strict("simulate", folder, "--model", path, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert says in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_gap_that_leaves_nothing_is_one_line(strict, recorded, tmp_path):
    columns = recorded | {"x_in_mm": np.full_like(recorded["x_in_mm"], np.nan)}
    folder = write_dataset(tmp_path / "d", [Run("a", columns, conditions(TRUE))])
    done = strict("simulate", folder, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "column x_in_mm is empty" in done.stderr


def test_an_extended_model_is_taken(strict, folder, model, tmp_path):
    text = model.read_text(encoding="utf-8")
    extended = tmp_path / "model-extended.toml"
    effect = "[effects.free_tendon.proximal_length_mm]\nvalue = 300.0\nunit = 'mm'\n"
    extended.write_text(text + effect, encoding="utf-8")
    rmse = []
    for path in (model, extended):
        out = tmp_path / path.stem
        done = strict("simulate", folder, "--model", path, "--out", out, "--json")
        assert (done.returncode, done.stderr) == (0, "")
        rmse.append(json.loads(done.stdout)["runs"]["a"]["channels"]["f_in_N"]["rmse"])
    assert rmse[1] > 3.0 * rmse[0]


def test_a_run_that_was_not_fitted_is_predicted_once_its_own_zeros_are_known(
    strict, recorded, model, tmp_path
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
    for name, file, options in (
        ("as it is", model, ()),
        ("own", model, ("--fit-own",)),
        ("wrong", tmp_path / "wrong.toml", ("--fit-own",)),
    ):
        call = ("--model", file, *options, "--runs", "b", "--out", tmp_path / name, "--json")
        done = strict("simulate", folder, *call)
        assert (done.returncode, done.stderr) == (0, "")
        summary = json.loads(done.stdout)
        assert list(summary["runs"]) == summary["chosen"] == ["b"]
        residuals[name] = summary["runs"]["b"]["channels"]["f_in_N"]
    assert residuals["own"]["rmse"] < 2.0 * residuals["own"]["noise"]
    assert residuals["as it is"]["rmse"] > 5.0 * residuals["own"]["rmse"]
    assert residuals["wrong"]["rmse"] > 3.0 * residuals["own"]["rmse"]
    again = ("--model", tmp_path / "own", "--runs", "b", "--out", tmp_path / "again", "--json")
    done = strict("simulate", folder, *again)  # with the model as it was used
    assert json.loads(done.stdout)["runs"]["b"]["channels"]["f_in_N"] == residuals["own"]


BRISTLES = """
[bristles]
stiffness_N_per_mm = {{ value = {stiffness}, unit = "N/mm" }}
damping_N_s_per_mm = {{ value = {damping}, unit = "N s/mm" }}
"""


def with_bristles(path, **values):
    text = 'format = 1\nkind = "model"\n' + BRISTLES.format(**values)
    path.write_text(text, encoding="utf-8")
    return path


def test_the_dynamic_model_says_whose_bristles_it_takes(strict, folder, tmp_path):
    done = strict("simulate", folder, "--dynamics", "lugre", "--out", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    assert "LuGre chain, 50 lumps" in done.stdout
    notes = [line for line in done.stdout.splitlines() if line.startswith("- ")]
    assert len(notes) == 1
    assert "Table 1" in notes[0]


def test_the_dynamic_model_says_where_sliding_is_unstable(strict, folder, tmp_path):
    for damping, unstable in ((15.8, True), (0.2, False)):
        model = with_bristles(tmp_path / "model.toml", stiffness=5000.0, damping=damping)
        call = ("--model", model, "--dynamics", "lugre", "--out", tmp_path / "out", "--force")
        done = strict("simulate", folder, *call)
        assert done.returncode == 0
        assert ("sliding is unstable in a dead band" in done.stdout) == unstable
        assert ("79.7 times critical" in done.stdout) == unstable


@pytest.mark.parametrize(
    ("stiffness", "damping"), [(-1.0, 0.2), (0.0, 0.2), (5000.0, -0.1), ("nan", 0.2)]
)
def test_bristles_that_cannot_be_are_refused(strict, folder, tmp_path, stiffness, damping):
    model = with_bristles(tmp_path / "model.toml", stiffness=stiffness, damping=damping)
    done = strict(
        "simulate", folder, "--model", model, "--dynamics", "lugre", "--out", tmp_path / "out"
    )
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "bristles." in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
def test_more_nodes_are_nearer_to_many(strict, folder, model, tmp_path, dynamics):
    f_in = {}
    for nodes in (5, 20, 200):
        call = ("--model", model, "--dynamics", dynamics, "--nodes", str(nodes), "--out")
        done = strict("simulate", folder, *call, tmp_path / f"{nodes}", "--json")
        assert (done.returncode, done.stderr) == (0, "")
        summary = json.loads(done.stdout)
        assert summary["nodes"] == nodes
        assert f" {nodes} " in summary["runs"]["a"]["solver"]
        table = pq.read_table(tmp_path / f"{nodes}" / "runs" / "a.parquet")
        f_in[nodes] = table["f_in_N"].to_numpy()
    off = {nodes: np.sqrt(np.mean((f_in[nodes] - f_in[200]) ** 2)) for nodes in (5, 20)}
    assert off[5] > 4.0 * off[20] > 0.0


@pytest.mark.parametrize(
    ("nodes", "dynamics", "says"),
    [
        ("1", "slip", "expected 2 to 1000"),
        ("1001", "lugre", "expected 2 to 1000"),
        ("50", "static", "the static model has no nodes"),
    ],
)
def test_nodes_that_no_chain_can_have(strict, folder, tmp_path, nodes, dynamics, says):
    call = ("simulate", folder, "--nodes", nodes, "--dynamics", dynamics)
    done = strict(*call, "--out", tmp_path / "s")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert says in done.stderr
    assert not (tmp_path / "s").exists()


def test_a_tendon_that_sticks_and_slips_is_reported_to(strict, folder, model, tmp_path):
    text = model.read_text(encoding="utf-8")
    text += (
        "[effects.stribeck_friction.excess]\nvalue = 0.15\nunit = '1'\n"
        "[effects.stribeck_friction.velocity_mm_per_s]\nvalue = 3.0\nunit = 'mm/s'\n"
    )
    model.write_text(text, encoding="utf-8")
    call = ("simulate", folder, "--model", model, "--dynamics", "lugre", "--out", tmp_path / "s")
    done = strict(*call)
    assert done.returncode == 0
    assert "sticks and slips" in done.stdout
    assert "friction falls with speed by more than the damping" in done.stdout
