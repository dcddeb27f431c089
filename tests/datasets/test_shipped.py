import tomllib
from pathlib import Path

import numpy as np
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.rig import make_datasets

DATASETS = Path(__file__).parents[2] / "datasets"


@pytest.mark.parametrize("groups", ["a", pytest.param("abcd", marks=pytest.mark.large)])
def test_the_shipped_files_are_made_again_byte_for_byte(tmp_path, monkeypatch, groups):
    chosen = {name: make_datasets.GROUPS[name] for name in groups}
    monkeypatch.setattr(make_datasets, "GROUPS", chosen)
    make_datasets.make(tmp_path)
    made = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    assert len(made) == len(groups) + 3 + 2 * 2
    if len(groups) < 4:
        made.remove(Path("paper-groups/dataset.toml"))  # which lists all of them
    for path in made:
        assert (tmp_path / path).read_bytes() == (DATASETS / path).read_bytes(), path


def test_the_shipped_files_are_small():
    assert sum(p.stat().st_size for p in DATASETS.rglob("*") if p.is_file()) < 5e6


@pytest.mark.parametrize("name", ["paper-groups", "drive-chirp"])
def test_simulated_data_say_so(name):
    manifest = read_dataset(DATASETS / name).manifest
    assert manifest.kind == "simulated"
    assert "not measured" in manifest.description
    assert manifest.rig.proximal_length_mm is None
    assert "not measured" in (DATASETS / name / "README.md").read_text(encoding="utf-8")


def test_paper_groups_are_table_2():
    runs = {recording.run.id: recording for recording in read_dataset(DATASETS / "paper-groups")}
    omega, radius = {"a": 1, "b": 2, "c": 1, "d": 1}, {"a": 250, "b": 250, "c": 200, "d": 200}
    assert list(runs) == list(omega)
    for name, recording in runs.items():
        t, x = recording.time_s, recording.columns["x_in_mm"]
        exact = 10.0 * np.sin(omega[name] * t - np.pi / 2.0) + 10.0
        assert (x - exact).std() == pytest.approx(0.005, rel=0.05)
        assert t[-1] == pytest.approx(4.0 * np.pi / omega[name], abs=0.002)
        run = recording.run
        assert run.sheath_length_mm == pytest.approx(radius[name] * run.total_bend_rad)


def test_paper_groups_hold_the_truth_that_they_state():
    """In full slip the ratio is the capstan's, and the load spring's line is its data sheet's."""
    truth = tomllib.loads((DATASETS / "paper-groups" / "truth.toml").read_text(encoding="utf-8"))
    for recording in read_dataset(DATASETS / "paper-groups"):
        columns, bend = recording.columns, recording.run.total_bend_rad
        smooth = np.convolve(columns["x_in_mm"], np.ones(101) / 101, mode="same")
        pulling = (columns["x_in_mm"] > 5.0) & (np.gradient(smooth) > 0.002)
        ratio = columns["f_in_N"][pulling].sum() / columns["f_out_N"][pulling].sum()
        assert np.log(ratio) == pytest.approx(truth["friction_coefficient"] * bend, rel=0.005)
        slope, preload = np.polyfit(columns["x_out_mm"], columns["f_out_N"], 1)
        assert slope == pytest.approx(truth["load_stiffness_N_per_mm"], rel=0.002)
        assert preload == pytest.approx(truth["preload_N"], abs=0.02)


def test_slow_motion_of_drive_chirp_gives_the_stated_gain():
    """x / ∫u = K k_d / (k_d + k_p) at a frequency far below the resonance."""
    truth = tomllib.loads((DATASETS / "drive-chirp" / "truth.toml").read_text(encoding="utf-8"))
    k_d, k_p = truth["drive_stiffness_N_per_mm"], truth["pull_back_N_per_mm"]
    sine = next(r for r in read_dataset(DATASETS / "drive-chirp") if r.run.id == "sine")
    turned = np.cumsum(sine.columns["motor_speed_rpm"]) * 1e-3
    slope = np.polyfit(turned, sine.columns["x_in_mm"], 1)[0]
    assert slope == pytest.approx(0.0236492 * k_d / (k_d + k_p), rel=1e-3)
