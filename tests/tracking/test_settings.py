"""Settings: the paper's rig without a file, and what a file may not say."""

import math

import pytest

from tsas_cli.support.errors import InputError
from tsas_cli.tracking.settings import Settings, printed_gains, read_settings


def test_the_drive_is_that_of_the_paper():
    drive = Settings().drive.actuator()
    assert drive.gain_mm_per_s_rpm == pytest.approx(0.0236492, rel=1e-5)
    assert drive.stiffness_N_per_mm == 52.0
    assert drive.inertia_N_s2_per_mm == pytest.approx(0.1296 / 27.1**2)
    assert (drive.damping_N_s_per_mm, drive.motor_lag_s, drive.speed_limit_rpm) == (
        0.007,
        0.002,
        3000.0,
    )


def test_gains_are_those_of_the_paper_and_come_to_their_places():
    laws = Settings().controllers.laws("pid", 0.02)
    assert laws.pid == (25.0, 65.0, 1.0)
    assert laws.sliding_mode.surface == (800.0, 1.0, 1.0, 1.2, 80.0)
    adaptive = laws.adaptive_sliding_mode
    assert adaptive.surface[:4] == (900.0, 1.0, 1.0, pytest.approx(1.115))
    assert laws.sliding_mode.phi == adaptive.start == (0.005, 18.0, 0.02)
    assert (adaptive.lowest, adaptive.highest) == ((0.0005, 1.8, 0.002), (0.05, 180.0, 0.2))
    assert adaptive.psi == (1e-8, 2e-4, 1e-6)
    assert laws.disturbance_observer == (10.0, 40.0, 0.02)


def test_printed_gains_are_a_thousandfold_ks_and_nothing_else():
    printed, usual = printed_gains(Settings()), Settings()
    laws = printed.controllers.laws("pid", 0.02)
    assert laws.sliding_mode.surface.ks == pytest.approx(1200.0)
    assert laws.adaptive_sliding_mode.surface.ks == pytest.approx(1115.0)
    back = printed.controllers.sliding_mode.model_copy(update={"ks": 1.2})
    assert back == usual.controllers.sliding_mode
    assert printed.controllers.pid == usual.controllers.pid
    assert printed.loop == usual.loop


def written(folder, text):
    path = folder / "settings.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_replaces_what_it_names(tmp_path):
    given = read_settings(
        written(tmp_path, "[sensor]\nrate_Hz = 200\n[controllers.sliding-mode]\nc1 = 3.0\n")
    )
    assert given.step_s == 0.005
    assert given.controllers.sliding_mode.c1 == 3.0
    assert given.controllers.adaptive_sliding_mode.c1 == 900.0
    assert given.reference.duration_s == pytest.approx(8.0 * math.pi)
    assert read_settings(None) == Settings()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[loop]\nfilter_hz = 10\n", "unknown key loop.filter_hz (did you mean filter_Hz?)"),
        (
            "[controllers.sliding_mode]\nks = 1\n",
            "unknown key controllers.sliding_mode (did you mean sliding-mode?)",
        ),
        ("[looop]\nnodes = 5\n", "unknown key looop (did you mean loop?)"),
        ("[loop]\nnodes = 1\n", "loop.nodes"),
        ("[sensor]\nrate_Hz = 10\n", "sensor.rate_Hz"),
        ("format = 2\n", "format"),
        ("[drive]\ngear_ratio = nan\n", "drive.gear_ratio"),
        ("[controllers.pid]\nkp = 1\n", "unknown key controllers.pid.kp"),
        (
            "[controllers.adaptive-sliding-mode]\nphi = [0.005, 1.0, 0.02]\n",
            "phi must lie between lowest and highest",
        ),
        (
            "[controllers.adaptive-sliding-mode]\nlowest = [0.06, 1.8, 0.002]\n",
            "phi must lie between lowest and highest",
        ),
    ],
)
def test_what_no_loop_can_have_is_refused(tmp_path, text, told):
    path = written(tmp_path, text)
    with pytest.raises(InputError) as refused:
        read_settings(path)
    assert told in str(refused.value)
    assert str(refused.value).startswith(str(path))
