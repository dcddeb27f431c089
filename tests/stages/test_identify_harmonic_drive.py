"""What is hidden in drive recordings of the independent rig is found, and nothing else."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.counted import Counted
from tests.drives import DATA_SHEET, LAGGING, SPRUNG, STIFF, drive_dataset
from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive
from tsas_studies.challenge.rig.drive import Gear

HIDDEN = {
    "lag": (LAGGING, Gear(), {"channel_delay": {"motor_lag_s": 0.004}}),
    "delay": (STIFF, Gear(delay_s=0.0047), {"channel_delay": {"delay_s": 0.0047}}),
    "spring": (SPRUNG, Gear(), {"drive_compliance": {"natural_frequency_Hz": 88.316}}),
    "ripple": (
        STIFF,
        Gear(ripple_sine_mm=0.02, ripple_cosine_mm=-0.01),
        {"drive_ripple": {"sine_mm": 0.02, "cosine_mm": -0.01}},
    ),
    "play": (STIFF, Gear(play_mm=0.05), {"backlash": {"play_mm": 0.05}}),
    "lag and play": (
        LAGGING,
        Gear(play_mm=0.05),
        {"channel_delay": {"motor_lag_s": 0.004}, "backlash": {"play_mm": 0.05}},
    ),
}
LARGE = pytest.mark.large  # of them "lag and play" has both
SURE = 4.0  # standard errors, in which no seed of these may miss


def identified(folder, *made, **options):
    dataset = drive_dataset(folder / "dataset", *made, **{"duration_s": 4.0} | options)
    counted = Counted()
    summary = identify_harmonic_drive(dataset, out=folder / "out", step=counted).summary
    assert counted.all_of(least=17)  # the recordings, and the structures of G(s)
    return summary


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=LARGE)])
def test_nothing_is_named_where_nothing_is_hidden(tmp_path, seed):
    summary = identified(tmp_path, STIFF, seed=seed)
    assert summary["diagnosis"]["verdict"] == "sufficient"
    assert summary["diagnosis"]["named"] == []
    assert summary["structure"]["name"] == "integrator"
    gain = summary["parameters"][0]
    assert gain["interval_low"] < 0.0236492 < gain["interval_high"] + 2e-6


@pytest.mark.parametrize(
    "hidden",
    [pytest.param(name, marks=LARGE if name in ("lag", "play") else ()) for name in HIDDEN],
)
def test_what_is_hidden_is_named_with_its_size(tmp_path, hidden):
    drive, gear, truth = HIDDEN[hidden]
    found = identified(tmp_path, drive, gear)["diagnosis"]
    assert found["verdict"] == "named"
    assert {c["effect"] for c in found["named"]} == set(truth)
    assert found["remainder"]["mean_square"] < 1.1
    for cause in found["named"]:
        low, high = cause["gain_interval_percent"]
        kinds = {"lag": "first-order lag", "delay": "pure delay"}
        assert cause["kind"] in (kinds.get(hidden, ""), kinds["lag"])
        assert cause["rivals"] == []
        assert 10.0 < low <= cause["gain_percent"] <= high
        for name, true in truth[cause["effect"]].items():
            told = cause["parameters"][name]
            assert abs(told["value"] - true) < SURE * told["stderr"]
            assert told["interval_low"] < told["value"] < told["interval_high"]
            assert not told["at_bound"]


INERTIA = {"inertia_N_mm_s2": 0.1296}


def test_sentence_json_and_tables_name_the_same_of_a_stiff_drive(tmp_path):
    """A compliance stood in sentence and JSON, with "no resonance" in a note and in no table."""
    stated = {"load_stiffness_N_per_mm": 1.579, "friction_coefficient": 0.125}
    sheet = DATA_SHEET | INERTIA | stated
    made = drive_dataset(tmp_path / "dataset", LAGGING, data_sheet=sheet, bend=math.pi)
    result = identify_harmonic_drive(made)
    found = result.summary["diagnosis"]
    assert [c["effect"] for c in found["named"]] == ["channel_delay"]
    _, _, structures = next(iter(result.tables()))
    assert [row[0] for row in structures if row[3] == "chosen"] == ["integrator with lag"]
    (table,) = [rows for title, _, rows in result.tables() if title == "causes"]
    assert {row[0] for row in table} == {"channel_delay"}
    assert "It lacks: a first-order lag of the motor. With it" in found["reason"]
    assert found["nominal"] == "x_in = g ∫u dt"
    (note,) = result.summary["cannot_tell"]
    assert "has a resonance at 18.3 Hz, which these recordings do not show" in note
    before, after = (found["channels"]["x_in_mm"][key] for key in ("rmse_before", "rmse_after"))
    assert after < 0.2 * before
    for recording in made:
        simulated = result[recording.run.id].columns
        told = result.summary["runs"][recording.run.id]
        for key, column in (("rmse", "x_in_mm"), ("rmse_nominal", "x_in_nominal_mm")):
            error = recording.columns["x_in_mm"] - simulated[column]
            assert told[key] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-6)


def test_a_lead_that_contradicts_the_data_sheet_is_told(tmp_path):
    summary = identified(tmp_path, LAGGING, data_sheet=DATA_SHEET | {"turntable_radius_mm": 54.2})
    (note,) = (note for note in summary["cannot_tell"] if "fitted lead" in note)
    assert "2 times the kinematic one of the data sheet, 21.14" in note


def test_a_slow_chirp_does_not_tell_them_and_says_so(tmp_path):
    """Up to 0.7 Hz a lag of 4 ms is a delay but for a few ten-thousandths of the amplitude."""
    summary = identified(tmp_path, LAGGING, to_Hz=0.7, only=("chirp",))
    (cause,) = summary["diagnosis"]["named"]
    assert cause["effect"] == "channel_delay"
    assert len(cause["rivals"]) >= 1
    assert summary["diagnosis"]["verdict"] == "ambiguous"
    assert summary["frequency_response"]["band_Hz"] is None
    assert any("No frequency has a coherence" in said for said in summary["cannot_tell"])


def test_a_chirp_to_ten_hertz_warns_of_poles_at_23(tmp_path):
    k_d = 52.0 * (23.0 / 88.316) ** 2
    soft = replace(SPRUNG, drive_stiffness_N_per_mm=k_d, pull_back_N_per_mm=0.1)
    summary = identified(tmp_path, soft, to_Hz=10.0, only=("chirp",))
    (warning,) = (s for s in summary["cannot_tell"] if "outside of the band" in s)
    assert "pole lies at 2" in warning


def test_with_the_inertia_the_resonance_becomes_a_stiffness(tmp_path):
    made = {"data_sheet": DATA_SHEET | INERTIA, "to_Hz": 150.0, "duration_s": 20.0}
    summary = identified(tmp_path, SPRUNG, **made)
    told = {p["name"]: p for p in summary["parameters"]}
    for name, true in (("drive_stiffness_N_per_mm", 52.0), ("pull_back_N_per_mm", 2.338456)):
        assert abs(told[name]["value"] - true) < SURE * told[name]["stderr"]
        assert told[name]["stderr"] < 0.03 * true
    assert told["inertia_N_mm_s2"]["origin"] == "data sheet"
    assert told["damping_N_s_per_mm"]["value"] == pytest.approx(0.007, rel=0.05)
    assert any("k_d + k_p would look like" in s for s in summary["cannot_tell"])
