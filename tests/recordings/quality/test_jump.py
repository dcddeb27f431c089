"""A position that jumps alone is an encoder's; a drive that jumps moves the tension too."""

import numpy as np
import pytest

from tests.recordings.quality.test_faults import GOOD, codes, remarks
from tests.recordings.quality.test_outlier import with_wild

AT = 1234


def after(value):
    return np.where(np.arange(GOOD["time_s"].size) >= AT, value, 0.0)


@pytest.mark.parametrize("name", ["x_in_mm", "x_out_mm"])
@pytest.mark.parametrize("value", [3.0, -40.0, 3e3])
def test_a_jump_of_one_position_is_said_with_its_row(name, value):
    found = dict(remarks(GOOD | {name: GOOD[name] + after(value)}))
    jump = found["jump"]
    assert (jump.severity, jump.column, jump.first_s) == ("error", name, GOOD["time_s"][AT])
    assert f"row {AT}" in jump.sentence


def test_what_all_channels_do_is_no_jump_of_an_encoder():
    moved = {name: GOOD[name] + after(3.0) for name in ("x_in_mm", "x_out_mm")}
    assert "jump" not in codes(GOOD | moved | {"f_in_N": GOOD["f_in_N"] + after(20.0)})


def test_a_sample_that_comes_back_and_a_usual_step_are_none():
    assert "jump" not in codes(with_wild("x_in_mm", AT, 50.0))
    usual = float(np.abs(np.diff(GOOD["x_in_mm"])).max())
    assert "jump" not in codes(GOOD | {"x_in_mm": GOOD["x_in_mm"] + after(3.0 * usual)})
    assert "jump" not in codes(GOOD)
