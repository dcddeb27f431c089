"""`tsas calibrate` in a process of its own, with every warning an error."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals.references import FOLDER
from tests.commands.documented import documented
from tests.rigs import dataset_of, recorded
from tsas_studies.challenge.rig.tendon import Rig

RIG = Rig(cells=60)
FREE_TENDON = """
format = 1
[effects.free_tendon]
proximal_length_mm = { value = 152.0, unit = 'mm' }
distal_length_mm = { value = 61.0, unit = 'mm' }
"""
IDS = ["a", "ü → 'b'", "<script>", "..c", "n" * 200]


@pytest.fixture
def folder(tmp_path):
    return dataset_of(RIG, tmp_path / "dataset", a=recorded(RIG))


def test_it_writes_what_is_documented(done, folder, tmp_path):
    out = tmp_path / "out"
    summary = json.loads(done("calibrate", folder, "--out", out, "--json"))
    text = (out / "calibration.json").read_text(encoding="utf-8")
    assert json.loads(text) == summary
    assert set(summary) == documented("calibration.json")
    assert {p.name for p in out.iterdir()} == {"SHA256SUMS", "calibration.json", "model.toml"}
    parameter = {"name", "run", "value", "stderr", "interval_low", "interval_high", "unit"}
    parameter |= {"at_bound", "origin"}
    assert all(set(p) == parameter for p in summary["parameters"] + summary["transfer"])
    nulls = re.findall(r'"(\w+)": null', text)
    assert set(nulls) <= {"run", "stderr", "interval_low", "interval_high"}
    assert len(nulls) == text.count("null")
    for p in summary["parameters"]:
        assert (p["stderr"] is None) == (p["interval_low"] is None) == (p["origin"] != "fitted")
    model = tomllib.loads((out / "model.toml").read_text(encoding="utf-8"))
    for p in summary["parameters"]:
        table = model["parameters"] if p["run"] is None else model["runs"][p["run"]]
        assert table[p["name"]]["value"] == p["value"]
        assert table[p["name"]]["unit"] == p["unit"]
    low, high = model["fitted_to"]["ranges"]["f_in_N"]
    assert 0.0 < low < high
    assert model["fitted_to"]["words"] == {"load": ["spring"]}


def test_it_prints_tables_and_says_what_cannot_be_told(done, folder, tmp_path):
    printed = done("calibrate", folder, "--out", tmp_path / "out")
    assert "stiffness km" in printed
    assert "- x_out_zero_mm is not identifiable together with preload_N" in printed
    assert done("calibrate", folder, "--out", tmp_path / "out", "--force", "--quiet") == ""


def test_odd_names_of_runs(done, tmp_path):
    """They name files, TOML keys and cells of a table, and break none of them."""
    runs = {f"r{k}": recorded(RIG, 50.0, seed=k) for k in range(len(IDS))}
    folder = dataset_of(RIG, tmp_path / "d", **runs)
    manifest = folder / "dataset.toml"
    text = manifest.read_text(encoding="utf-8")
    for k, name in enumerate(IDS):
        text = text.replace(f'id = "r{k}"', f"id = {json.dumps(name, ensure_ascii=False)}")
    manifest.write_text(text, encoding="utf-8")
    printed = done("calibrate", folder, "--out", tmp_path / "c", "--json")
    assert list(json.loads(printed)["channels"]) == IDS
    done("simulate", folder, "--model", tmp_path / "c", "--out", tmp_path / "s", "-q")
    assert {p.stem for p in (tmp_path / "s" / "runs").iterdir()} == set(IDS)


@pytest.mark.parametrize("names", [("x_in_mm",), ("f_in_N", "f_out_N"), ("x_in_mm", "x_out_mm")])
def test_a_wrong_sign_is_one_line(refused, tmp_path, names):
    turned = {name: -v if name in names else v for name, v in recorded(RIG).items()}
    folder = dataset_of(RIG, tmp_path / "d", a=turned)
    assert "invert the sign of" in refused("calibrate", folder, "--out", tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_what_the_dynamic_model_is_fitted_to_drives_it_again(done, tmp_path):
    """Bristles and friction over speed go into the model, and `simulate` takes them from there."""
    table = pq.read_table(FOLDER / "speeds-50.parquet")
    rng = np.random.default_rng(5)
    columns = {name: table[name].to_numpy() for name in table.column_names}
    for name in set(columns) - {"time_s"}:
        noise = 0.03 if name.endswith("_N") else 0.002
        columns[name] = columns[name] + noise * rng.standard_normal(len(table))
    folder = dataset_of(RIG, tmp_path / "d", a=columns)
    call = ("calibrate", folder, "--dynamics", "lugre", "--out", tmp_path / "c", "--json")
    summary = json.loads(done(*call))
    assert (summary["dynamics"], summary["fit"]["solver"][0][:5]) == ("lugre", "LuGre")
    model = tomllib.loads((tmp_path / "c" / "model.toml").read_text(encoding="utf-8"))
    assert model["bristles"]["stiffness_N_per_mm"]["origin"] == "fitted"
    assert model["effects"]["stribeck_friction"]["excess"]["value"] == pytest.approx(0.1, rel=0.02)
    call = ("simulate", folder, "--model", tmp_path / "c", "--dynamics")
    rmse = {}
    for dynamics in ("lugre", "slip"):
        simulated = json.loads(done(*call, dynamics, "--out", tmp_path / dynamics, "--json"))
        rmse[dynamics] = simulated["runs"]["a"]["channels"]["f_in_N"]["rmse"]
    assert rmse["lugre"] == pytest.approx(summary["channels"]["a"]["f_in_N"]["rmse"])
    assert rmse["slip"] > 5.0 * rmse["lugre"]


def test_effects_of_a_model_stay(done, tmp_path):
    """The shipped groups have free tendon at both ends and no bristles; without it they seem to."""
    (tmp_path / "m.toml").write_text(FREE_TENDON, encoding="utf-8")
    shipped = Path(__file__).parents[2] / "datasets" / "paper-groups"
    call = ("calibrate", shipped, "--runs", "a", "--model", tmp_path / "m.toml", "--json")
    summary = json.loads(done(*call, "--dynamics", "lugre", "--out", tmp_path / "c"))
    assert summary["model"]["file"] == "m.toml"
    values = {p["name"]: p["value"] for p in summary["parameters"]}
    assert values["free_tendon.proximal_length_mm"] == 152.0
    assert values["friction_coefficient"] == pytest.approx(0.125, rel=2e-3)
    assert values["tendon_stiffness_N"] == pytest.approx(67858.4, rel=6e-3)
    said = (s for s in summary["cannot_tell"] if "fit equally well" in s)
    (sentence,) = (s for s in said if "stiffness" in s)
    assert float(sentence.split("identifiable: ")[1].split(" ")[0]) > 2e4
    assert not any("lacks an effect" in s for s in summary["cannot_tell"])
