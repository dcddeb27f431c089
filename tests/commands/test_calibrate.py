"""`tsas calibrate` in a process of its own, with every warning an error."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals.references import FOLDER
from tests.commands.documented import documented
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

RIG = Rig(cells=60)
IDS = ["a", "ü → 'b'", "<script>", "..c", "n" * 200]


@pytest.fixture(scope="module")
def recorded():
    return record(RIG, sine(rate_Hz=200.0), sensors=Sensors(rate_Hz=100.0))


@pytest.fixture
def folder(tmp_path, recorded):
    return write_dataset(tmp_path / "dataset", [Run("a", recorded, conditions(RIG))])


def nulls(content, path=""):
    """Return the paths of all nulls in JSON content."""
    if isinstance(content, dict):
        return [p for k, v in content.items() for p in nulls(v, f"{path}.{k}")]
    if isinstance(content, list):
        return [p for v in content for p in nulls(v, path)]
    return [path] if content is None else []


def test_it_writes_what_is_documented(strict, folder, tmp_path):
    done = strict("calibrate", folder, "--out", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    assert json.loads(done.stdout) == summary
    assert set(summary) == documented("calibration.json")
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "SHA256SUMS",
        "calibration.json",
        "model.toml",
    }
    parameter = {
        *("name", "run", "value", "stderr", "interval_low", "interval_high"),
        *("unit", "at_bound", "origin"),
    }
    assert all(set(p) == parameter for p in summary["parameters"] + summary["transfer"])
    allowed = (".run", ".stderr", ".interval_low", ".interval_high")
    assert all(path.endswith(allowed) for path in nulls(summary))
    for p in summary["parameters"]:
        assert (p["stderr"] is None) == (p["interval_low"] is None) == (p["origin"] != "fitted")
    model = tomllib.loads((tmp_path / "out" / "model.toml").read_text(encoding="utf-8"))
    for p in summary["parameters"]:
        table = model["parameters"] if p["run"] is None else model["runs"][p["run"]]
        assert table[p["name"]]["value"] == p["value"]
        assert table[p["name"]]["unit"] == p["unit"]
    low, high = model["fitted_to"]["ranges"]["f_in_N"]
    assert 0.0 < low < high
    assert model["fitted_to"]["words"] == {"load": ["spring"]}


def test_it_prints_tables_and_says_what_cannot_be_told(strict, folder, tmp_path):
    done = strict("calibrate", folder, "--out", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    assert "stiffness km" in done.stdout
    assert "- x_out_zero_mm is not identifiable together with preload_N" in done.stdout
    quiet = strict("calibrate", folder, "--out", tmp_path / "out", "--force", "--quiet")
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")


def test_odd_names_of_runs(strict, tmp_path):
    """They name files, TOML keys and cells of a table, and break none of them."""
    clean = simulate(RIG, sine())
    runs = [
        Run(f"r{k}", measure(clean, Sensors(rate_Hz=50.0), seed=k), conditions(RIG))
        for k in range(len(IDS))
    ]
    folder = write_dataset(tmp_path / "d", runs)
    manifest = folder / "dataset.toml"
    text = manifest.read_text(encoding="utf-8")
    for k, name in enumerate(IDS):
        text = text.replace(f'id = "r{k}"', f"id = {json.dumps(name, ensure_ascii=False)}")
    manifest.write_text(text, encoding="utf-8")
    done = strict("calibrate", folder, "--out", tmp_path / "c", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert list(json.loads(done.stdout)["channels"]) == IDS
    done = strict("simulate", folder, "--model", tmp_path / "c", "--out", tmp_path / "s", "-q")
    assert (done.returncode, done.stderr) == (0, "")
    assert {p.stem for p in (tmp_path / "s" / "runs").iterdir()} == set(IDS)


def test_integer_and_float32_and_further_columns(strict, recorded, tmp_path):
    """Micrometres in whole numbers as another tool may write them are no obstacle."""
    folder = write_dataset(tmp_path / "d", [Run("a", recorded, conditions(RIG))])
    path = folder / "runs" / "a.parquet"
    table = pa.table(
        {
            "time_s": pa.array(recorded["time_s"], pa.float64()),
            "x_in_mm": pa.array(recorded["x_in_mm"], pa.float32()),
            "f_in_N": pa.array(np.round(recorded["f_in_N"]).astype(np.int16)),
            "f_out_N": pa.array(recorded["f_out_N"], pa.float32()),
            "comment": pa.array(["x"] * recorded["time_s"].size),
        }
    )
    pq.write_table(table, path)
    rewrite_checksum(folder, path)
    done = strict("calibrate", folder, "--out", tmp_path / "c", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    found = {p["name"]: p["value"] for p in json.loads(done.stdout)["parameters"]}
    assert found["friction_coefficient"] == pytest.approx(0.125, rel=0.01)


def rewrite_checksum(folder, path):
    import hashlib

    manifest = folder / "dataset.toml"
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(re.sub(r'sha256 = "\w+"', f'sha256 = "{digest}"', text), encoding="utf-8")


@pytest.mark.parametrize("names", [("x_in_mm",), ("f_in_N", "f_out_N"), ("x_in_mm", "x_out_mm")])
def test_a_wrong_sign_is_one_line(strict, recorded, tmp_path, names):
    turned = {name: -v if name in names else v for name, v in recorded.items()}
    folder = write_dataset(tmp_path / "d", [Run("a", turned, conditions(RIG))])
    done = strict("calibrate", folder, "--out", tmp_path / "c")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "invert the sign of" in done.stderr
    assert not (tmp_path / "c").exists()


def test_what_the_dynamic_model_is_fitted_to_drives_it_again(strict, tmp_path):
    """Bristles and friction over speed go into the model, and `simulate` takes them from there."""
    table = pq.read_table(FOLDER / "speeds-50.parquet")
    rng = np.random.default_rng(5)
    columns = {name: table[name].to_numpy() for name in table.column_names}
    for name in set(columns) - {"time_s"}:
        noise = 0.03 if name.endswith("_N") else 0.002
        columns[name] = columns[name] + noise * rng.standard_normal(len(table))
    folder = write_dataset(tmp_path / "d", [Run("a", columns, conditions(RIG))])
    done = strict("calibrate", folder, "--dynamics", "lugre", "--out", tmp_path / "c", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert (summary["dynamics"], summary["fit"]["solver"][0][:5]) == ("lugre", "LuGre")
    model = tomllib.loads((tmp_path / "c" / "model.toml").read_text(encoding="utf-8"))
    assert model["bristles"]["stiffness_N_per_mm"]["origin"] == "fitted"
    assert model["effects"]["stribeck_friction"]["excess"]["value"] == pytest.approx(0.1, rel=0.02)
    call = ("simulate", folder, "--model", tmp_path / "c", "--dynamics")
    rmse = {}
    for dynamics in ("lugre", "slip"):
        done = strict(*call, dynamics, "--out", tmp_path / dynamics, "--json")
        rmse[dynamics] = json.loads(done.stdout)["runs"]["a"]["channels"]["f_in_N"]["rmse"]
    assert rmse["lugre"] == pytest.approx(summary["channels"]["a"]["f_in_N"]["rmse"])
    assert rmse["slip"] > 5.0 * rmse["lugre"]


def test_effects_of_a_model_stay(strict, tmp_path):
    """The shipped groups have free tendon at both ends and no bristles; without it they seem to."""
    (tmp_path / "m.toml").write_text(
        "format = 1\n[effects.free_tendon]\n"
        "proximal_length_mm = { value = 152.0, unit = 'mm' }\n"
        "distal_length_mm = { value = 61.0, unit = 'mm' }\n",
        encoding="utf-8",
    )
    shipped = Path(__file__).parents[2] / "datasets" / "paper-groups"
    call = ("calibrate", shipped, "--runs", "a,c", "--model", tmp_path / "m.toml", "--json")
    done = strict(*call, "--dynamics", "lugre", "--out", tmp_path / "c")
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary["model"]["file"] == "m.toml"
    values = {p["name"]: p["value"] for p in summary["parameters"]}
    assert values["free_tendon.proximal_length_mm"] == 152.0
    assert values["friction_coefficient"] == pytest.approx(0.125, rel=2e-3)
    assert values["tendon_stiffness_N"] == pytest.approx(67858.4, rel=6e-3)
    (sentence,) = [
        s for s in summary["cannot_tell"] if "fit equally well" in s and "stiffness" in s
    ]
    assert float(sentence.split("identifiable: ")[1].split(" ")[0]) > 2e4
    assert not any("wrong somewhere" in s for s in summary["cannot_tell"])


def test_a_short_recording_is_no_error_and_no_number(strict, recorded, tmp_path):
    """Two rows: the data sheet's values without intervals, and the reason."""
    short = {name: v[100:102] for name, v in recorded.items()}
    folder = write_dataset(tmp_path / "d", [Run("a", short, conditions(RIG))])
    done = strict("calibrate", folder, "--out", tmp_path / "c", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert all(p["stderr"] is None for p in summary["parameters"])
    assert summary["fit"]["message"] == "nothing to fit"
    assert summary["cannot_tell"]
    assert summary["channels"]["a"]["f_in_N"]["noise"] is None
