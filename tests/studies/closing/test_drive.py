"""The drive's case: recorded with a spring in the tendon's place."""

import numpy as np
import pytest

from tsas_cli.support.errors import InputError
from tsas_cli.tracking.settings import SensorSettings, Settings
from tsas_studies.closing.drive import driven, known_drives, record_drive, spring_alone

SETTINGS = Settings()


def test_a_spring_alone_answers_as_a_straight_drive(tmp_path):
    speed = np.full(2000, 400.0)
    travel = driven(speed, spring_alone(SETTINGS), seed=1)
    pulls_back = 1.0 + 1.579 / 52.0  # the spring winds up the gear
    rate = (travel[-1] - travel[1000]) / 0.999
    assert rate == pytest.approx(400.0 * 0.0236492 / pulls_back, rel=2e-3)
    coarse = Settings(sensor=SensorSettings(rate_Hz=200.0))
    record_drive(coarse, tmp_path / "dataset")
    with pytest.raises(InputError, match=r"drive\.toml"):
        known_drives(tmp_path / "dataset", coarse)
