"""A run followed with two models at the same moments."""

import math

import numpy as np
import pytest

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.recordings.manifest import Run
from tsas_cli.reporting.stream.sources import EXTENDED, NOMINAL
from tsas_cli.reporting.stream.tendon.followed import follow

TIME_S = 5.0 + np.arange(0.0, 6.6, 1e-3)  # a recording's clock need not begin at zero
X_IN = 10.0 - 10.0 * np.cos(TIME_S - 5.0)
RUN = Run(
    id="a",
    file="a.parquet",
    sha256="0" * 64,
    sheath_length_mm=785.0,
    total_bend_rad=math.pi,
    preload_N=25.0,
)
VALUES = {
    "friction_coefficient": (0.125, "1"),
    "load_stiffness_N_per_mm": (1.579, "N/mm"),
    "tendon_stiffness_N": (67858.0, "N"),
    "preload_N": (25.0, "N"),
}
FREE = {
    "free_tendon.proximal_length_mm": (150.0, "mm"),
    "free_tendon.distal_length_mm": (60.0, "mm"),
}


def model(**values):
    return Model(tuple(Estimate(name, v, u, "default") for name, (v, u) in values.items()))


@pytest.fixture(scope="module")
def both():
    drive = DriveInput(X_IN, time_s=TIME_S - 5.0)
    models = {NOMINAL: model(**VALUES), EXTENDED: model(**VALUES, **FREE)}
    answers = [simulate(one.rig(RUN), drive).f_in_N for one in models.values()]
    return follow(RUN, TIME_S, drive, models, answers)


def test_same_moments_in_the_recordings_own_time(both):
    nominal, extended = both[NOMINAL], both[EXTENDED]
    np.testing.assert_array_equal(nominal.frames.samples, extended.frames.samples)
    assert nominal.time_s[0] == 5.0
    assert nominal.time_s[-1] == TIME_S[-1]
    np.testing.assert_array_equal(nominal.x_in_mm, X_IN[nominal.frames.samples])


def test_the_place_of_each_point_of_the_tendon_follows_from_its_stretch(both):
    """At the drive it is x_in less the free tendon's stretch; at the load the spring's tells it."""
    for one, (proximal, distal) in ((both[NOMINAL], (0.0, 0.0)), (both[EXTENDED], (150.0, 60.0))):
        moved, tension = one.moved_mm(), one.frames.tension_N
        give = 1.0 / 67858.0
        at_drive = one.x_in_mm - proximal * give * (tension[:, 0] - 25.0)
        np.testing.assert_allclose(moved[:, 0], at_drive, atol=1e-12)
        stretch = distal * give * (tension[:, -1] - 25.0)
        np.testing.assert_allclose(moved[:, -1], one.x_out_mm + stretch, atol=2e-3)
        np.testing.assert_allclose(one.x_out_mm, (tension[:, -1] - 25.0) / 1.579, atol=1e-9)


def test_free_tendon_makes_the_front_come_later(both):
    arrived = [[p.arrived - p.start for p in one.passages] for one in both.values()]
    assert len(arrived[0]) == 3
    assert (np.array(arrived[1]) > np.array(arrived[0])).all()


def test_the_last_turn_and_the_front_of_each_moment(both):
    one = both[NOMINAL]
    turned = one.turned()
    starts = [passage.start for passage in one.passages]
    assert set(turned) == {0, *starts}
    assert (turned <= one.frames.samples).all()
    assert set(starts) <= set(one.frames.samples)
    runs, at_front = one.front_runs_now, one.tension_at_front()
    assert 20 < runs.sum() < runs.size
    kinks = np.where(one.frames.slip[runs, 0] > 0, 1.0, -1.0)
    assert (kinks * (one.frames.tension_N[runs, 0] - at_front[runs]) > 0.0).all()
    assert (one.slips.all(axis=1) == (one.frames.front == 1.0)).all()


def test_the_lumped_model_has_no_tendon():
    drive = DriveInput(X_IN, time_s=TIME_S - 5.0)
    assert follow(RUN, TIME_S, drive, {NOMINAL: model(**VALUES)}, [X_IN], "static") == {}
