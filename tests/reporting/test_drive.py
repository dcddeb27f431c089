"""The page of a drive, from what the stage really writes."""

import re

import pytest

from tests.drives import SPRUNG, drive_dataset
from tests.reporting.made_folders import page_from
from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("drive")
    data = drive_dataset(root / "dataset", SPRUNG, duration_s=6.0, to_Hz=120.0)
    summary = identify_harmonic_drive(data, out=root / "out").summary
    return summary, page_from(root / "out")


def test_the_verdict_its_numbers_and_plots_stand_on_the_page_and_nothing_of_a_tendon(made):
    summary, text = made
    assert re.findall(r'<section id="([a-z]+)"', text) == ["drive", "recordings", "repeat"]
    assert "was given" not in text
    (cause,) = summary["diagnosis"]["named"]
    assert cause["effect"] == "drive_compliance"
    assert "compliance of the drive, whose stiffness reacts" in text
    assert "42.28" in text
    pictures = re.findall(r'<svg[^>]*aria-label="([^"]*)"', text)
    assert [p.split(" ")[0] for p in pictures] == ["From", "Poles", "Measured"]
    assert "magnitude and phase: 1.67 Hz 0.00216 mm" in pictures[0]
    assert "pole at 88" in pictures[1]
    assert "nominal −" in pictures[2]
    assert "tsas identify-harmonic-drive" in text


def test_the_plots_show_powers_of_ten_and_both_curves(made):
    _, text = made
    bode = next(p for p in re.findall(r"<svg.*?</svg>", text, re.DOTALL) if "Fitted magnitude" in p)
    assert "10⁻³" in bode
    assert "mathdefault" not in bode
    assert "var(--measured)" in bode
    assert "var(--simulated)" in bode


def test_values_come_first_and_what_was_tried_is_folded(made):
    summary, text = made
    assert text.index("gain_mm_per_s_rpm") < text.index("What was tried</h3></summary>")
    assert text.index("What was tried</h3></summary>") < text.index("Structures of G(s)")
    assert ">x_in against measurement [mm]<" in text
    assert f"Next: {summary['diagnosis']['next_experiment']}" in text
    assert "A diamond" not in text
