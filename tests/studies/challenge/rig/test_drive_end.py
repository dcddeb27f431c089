import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.drive_end import DriveEnd, followed, sensed_force, tendon_end
from tsas_studies.challenge.rig.motions import sine, through
from tsas_studies.challenge.rig.tendon import Rig, simulate

MOTION = through([10.0, 2.0, 12.0], speed_mm_s=4.0, rate_Hz=200.0)


def run(**options):
    return simulate(Rig(cells=60, drive_end=DriveEnd(**options)), MOTION).columns


PERFECT = run()
TURN = int(np.argmax(np.diff(MOTION.x_in_mm) < 0.0))  # the last sample of the first pull


def test_what_is_dragged_with_play():
    drive = np.array([0.0, 0.3, 1.0, 0.8, 0.0, 0.5, 2.0])
    assert followed(drive, 1.0) == pytest.approx([0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 1.5])
    np.testing.assert_array_equal(followed(drive, 0.0), drive)


def test_the_gear_turns_unevenly():
    end = DriveEnd(ripple_sine_mm=0.03, ripple_cosine_mm=0.02, ripple_period_mm=0.8)
    assert tendon_end(end, np.array([0.0, 0.2, 0.4, 0.6, 0.8])) == pytest.approx(
        [0.0, 0.2 + 0.03 - 0.02, 0.4 - 0.04, 0.6 - 0.03 - 0.02, 0.8]
    )


def test_friction_of_the_drive_jumps_by_twice_its_size_at_a_reversal():
    more = run(friction_N=1.5)["f_in_N"] - PERFECT["f_in_N"]
    assert more[20 : TURN + 1] == pytest.approx(1.5)
    assert more[TURN + 1 : TURN + 300] == pytest.approx(-1.5)
    np.testing.assert_array_equal(run(friction_N=1.5)["f_out_N"], PERFECT["f_out_N"])


def test_a_rough_spot_is_felt_where_it_is():
    end = DriveEnd(rough_N=3.0, rough_at_mm=6.0, rough_width_mm=0.5)
    x = sine().x_in_mm
    more = sensed_force(end, sine().time_s, x, np.zeros(x.size))
    assert np.abs(more[np.abs(x - 6.0) > 2.0]).max() < 1e-6
    for i in np.flatnonzero(np.diff(np.sign(x - 6.0)))[:4]:
        assert more[i] == pytest.approx(math.copysign(3.0, x[i + 1] - x[i]), rel=1e-3)


def test_a_pulley_at_the_drive_takes_its_share_of_the_tension_both_ways():
    columns = run(pulley_share=0.05)
    ratio = columns["f_in_N"] / PERFECT["f_in_N"]
    assert ratio[20 : TURN + 1] == pytest.approx(1.05)
    assert ratio[TURN + 1 : TURN + 300] == pytest.approx(0.95)
