"""What is hidden in drive recordings of the independent rig is found, and nothing else."""

from dataclasses import replace

import pytest

from tests.counted import Counted
from tests.drives import LAGGING, SPRUNG, STIFF, drive_dataset
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
SURE = 4.0  # standard errors, in which no seed of these may miss


def identified(folder, *made, **options):
    dataset = drive_dataset(folder / "dataset", *made, **options)
    counted = Counted()
    summary = identify_harmonic_drive(dataset, out=folder / "out", step=counted).summary
    assert counted.all_of(least=17)  # the recordings, and the structures of G(s)
    return summary


@pytest.mark.parametrize("seed", [1, 2])
def test_nothing_is_named_where_nothing_is_hidden(tmp_path, seed):
    summary = identified(tmp_path, STIFF, seed=seed)
    assert summary["diagnosis"]["verdict"] == "sufficient"
    assert summary["diagnosis"]["named"] == []
    assert summary["structure"]["name"] == "integrator"
    gain = summary["parameters"][0]
    assert gain["interval_low"] < 0.0236492 < gain["interval_high"] + 2e-6


@pytest.mark.parametrize("hidden", HIDDEN)
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
    sheet = {"turntable_radius_mm": 27.1, "gear_ratio": 120.0, "inertia_N_mm_s2": 0.1296}
    summary = identified(tmp_path, SPRUNG, data_sheet=sheet, to_Hz=150.0, duration_s=20.0)
    told = {p["name"]: p for p in summary["parameters"]}
    for name, true in (("drive_stiffness_N_per_mm", 52.0), ("pull_back_N_per_mm", 2.338456)):
        assert abs(told[name]["value"] - true) < SURE * told[name]["stderr"]
        assert told[name]["stderr"] < 0.03 * true
    assert told["damping_N_s_per_mm"]["value"] == pytest.approx(0.007, rel=0.05)
    assert any("k_d + k_p would look like" in s for s in summary["cannot_tell"])
