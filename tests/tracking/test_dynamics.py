"""`track` with a dynamic tendon: close to the quasi-static one, honest where it cannot go on."""

import numpy as np
import pyarrow.parquet as pq
import pytest

from tsas_cli.stages.track import track
from tsas_cli.support.errors import InputError

DAMPING = "bristles.damping_N_s_per_mm"  # 15.8 is the paper's, 80 times critical


@pytest.fixture
def settings(tmp_path):
    path = tmp_path / "settings.toml"
    path.write_text("reference.duration_s = 7.0\n")
    return path


def test_the_plant_is_dynamic_and_nearly_the_same(tmp_path, settings):
    forces, summaries = [], []
    for dynamics in ("slip", "lugre"):
        out = tmp_path / dynamics
        summaries.append(track(settings=settings, dynamics=dynamics, out=out).summary)
        run = pq.read_table(out / "runs" / "adaptive-sliding-mode-undisturbed.parquet")
        forces.append(run["f_out_true_N"].to_numpy())
    off = np.max(np.abs(forces[1] - forces[0])) / np.ptp(forces[0])
    assert 1e-5 < off < 1e-2
    slip, lugre = summaries
    assert (slip["dynamics"], lugre["dynamics"]) == ("slip", "lugre")
    assert lugre["results"][0]["unsettled_steps"] == 0
    assert slip["notes"] == []
    assert lugre["notes"] == ["the stiffness of the plant's bristles is that of Yang 2025, Table 1"]


def test_unstable_sliding_is_said(tmp_path, settings):
    strong = [f"{DAMPING}=5", "bristles.stiffness_N_per_mm=6000"]
    notes = track(settings=settings, dynamics="lugre", disturb=strong).summary["notes"]
    assert any(note.startswith("disturbed: sliding is unstable in a dead band") for note in notes)


def test_a_tendon_that_cannot_be_followed_is_one_line(tmp_path, settings):
    with pytest.raises(InputError, match=r"cannot be followed.*leave out \[bristles.damping"):
        track(
            settings=settings,
            dynamics="lugre",
            disturb=f"{DAMPING}=15.8",
            out=tmp_path / "out",
        )
    assert not (tmp_path / "out").exists()


def test_a_model_with_two_tendons_is_refused(tmp_path, settings):
    model = tmp_path / "pair.toml"
    model.write_text("format = 1\n[effects.antagonist.preload_N]\nvalue = 20.0\nunit = 'N'\n")
    for files in ({"model": model}, {"plant": model}):
        with pytest.raises(InputError, match=r"antagonist is in the model.*leave out"):
            track(settings=settings, **files)
    with pytest.raises(InputError, match=r"unknown quantity antagonist.preload_N"):
        track(settings=settings, disturb="antagonist.preload_N=20")
