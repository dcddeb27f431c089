"""What a law says: numbers that follow from its equation, and nothing of what is too small."""

import numpy as np
import pytest

from tsas_cli.diagnosis.law_words import after_reversal, sentence_of
from tsas_cli.effects import LAWS

NOTHING = {law.name: {p.name: p.neutral for p in law.parameters} for law in LAWS}
TENSIONS = (5.0, 25.0)


def said(name, **values):
    return sentence_of(name, NOTHING[name] | values, TENSIONS)


@pytest.mark.parametrize("name", NOTHING)
def test_a_law_of_nothing_says_nothing(name):
    assert said(name) == ""


def test_friction_at_the_drive_is_twice_the_weights_and_grows_with_the_tension():
    """1 N and a tenth of 5 to 25 N, both ways: 3 N to 7 N."""
    assert said("drive_law", friction_1_N=1.0) == (
        "At the drive friction changes f_in by 2 N after each reversal, within 1.8 mm."
    )
    text = said("drive_law", friction_1_N=1.0, share_1=0.1)
    assert "by 3 N at low and 7 N at high tension after each reversal" in text


def test_friction_at_the_drive_that_differs_with_the_speed_is_said():
    text = said("drive_law", friction_1_N=1.0, speed_2=-0.1, speed_3=-0.2)
    assert text.endswith("; friction changes from 0 to -20 % from 1 to 10 mm/s.")
    assert "mm/s" not in said("drive_law", friction_1_N=1.0, speed_3=0.02)


def test_a_gap_is_said_where_it_carries_most():
    """Of width travel: a gap as long as the width."""
    text = said("drive_law", travel_mm=4.0, gap_friction_1_N=2.0, friction_1_N=0.5)
    assert "by 5 N after each reversal, within " in text
    assert text.endswith("hardly over a gap of 4 mm in its middle.")
    assert "gap" not in said("drive_law", travel_mm=4.0, gap_friction_1_N=0.5, friction_1_N=2.0)


def test_what_is_small_beside_the_rest_is_left_out():
    curve = dict(
        zip((f"curve_{k}_mm" for k in range(1, 6)), (0.0, 1.0, 2.0, 3.0, 4.0), strict=True)
    )
    text = said("load_law", lost_1_mm=0.01, compliance_mm_per_N=1e-4, **curve)
    # About its mean, which is the zero of x_out.
    assert text == "At the load x_out deviates from -2 to 2 mm along the stroke."
    assert "yields by 0.1 mm per N" in said("load_law", lost_1_mm=0.5, compliance_mm_per_N=0.1)


def test_friction_in_the_sheath_is_said_in_percent():
    text = said("tendon_law", start_1=0.3, speed_2=-0.1, speed_3=0.2)
    assert text.startswith("In the sheath friction differs by 30 % after each reversal")
    assert "friction changes between -10 and 20 % from 1 to 10 mm/s" in text


def test_the_change_after_a_reversal_ends_at_twice_the_weights():
    value = NOTHING["load_law"] | {"lost_1_mm": 0.2, "lost_2_mm": 0.1}
    travel = np.array([0.0, 0.25, 0.5, 2.0, 9.0])  # widths of 1 and 0.25 mm
    expected = [0.0, 0.05 + 0.1, 0.1 + 0.2, 0.6, 0.6]
    assert after_reversal("load_law", value, travel, 0.0) == pytest.approx(expected)
