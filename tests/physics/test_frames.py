"""What is along the tendon: the chain against its own ends, and against the capstan's law."""

import numpy as np
import pytest

from tests.physics.references import (
    FREE,
    GROUP_A,
    LOADED_BY_SPRING,
    course_of,
    pulled_through,
    slip_chain,
    through,
    wrap_of,
)
from tsas_cli.effects import Effects, Presliding
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.frames import empty_frames, is_next, slips_up_to
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import NODES, simulate

TIME_S = np.arange(0.0, 6.3, 1e-3)
SINE = 10.0 - 10.0 * np.cos(TIME_S)


def chain(x, rig, frames):
    return slip_chain(course_of(x, rig), rig, LOADED_BY_SPRING, frames.slip.shape[1], frames)


@pytest.mark.parametrize("nodes", [None, 20])
def test_ends_of_the_profile_are_those_of_the_same_simulation(nodes):
    drive = DriveInput(SINE, time_s=TIME_S, start_f_in_N=30.0)
    at = np.arange(0, SINE.size, 7)
    answer = simulate(GROUP_A, drive, nodes=nodes, looked_at=at)
    assert answer.solver == f"slip chain, {nodes or NODES} nodes"
    frames = answer.frames
    np.testing.assert_array_equal(frames.samples, at)
    np.testing.assert_allclose(frames.tension_N[:, 0], answer.f_in_N[at], rtol=1e-12)
    np.testing.assert_allclose(frames.tension_N[:, -1], answer.f_out_N[at], rtol=1e-12)
    assert np.ptp(answer.f_in_N - answer.f_out_N) > 20.0  # the ends are not each other's
    plain = simulate(GROUP_A, drive, nodes=nodes or NODES)
    np.testing.assert_array_equal(plain.f_in_N, answer.f_in_N)  # looking changes nothing
    np.testing.assert_array_equal(plain.phase, answer.phase)
    assert plain.frames is None


@pytest.mark.parametrize("rig", [GROUP_A, FREE])
@pytest.mark.parametrize("factors", [[1.2, 2.0, 1.5, 1.7, 1.55, 1.65, 0.9], [0.8, 1.3], [1.3]])
def test_along_the_tendon_are_the_exponentials_of_its_strokes(rig, factors):
    """Each lays its exponential over what was before, up to where both meet: its front."""
    tensions, n = 25.0 * np.array(factors), 200
    x_in, _ = pulled_through(rig, tensions)
    frames = empty_frames(np.arange(x_in.size), n)
    chain(x_in, rig, frames)
    nodes, middles = np.linspace(0.0, 1.0, n + 1), (np.arange(n) + 0.5) / n
    along, between = np.full(n + 1, 25.0), np.full(n, 25.0)
    for k, way in enumerate(np.sign(np.diff(tensions, prepend=25.0))):
        extreme = np.maximum if way > 0 else np.minimum
        along = extreme(along, tensions[k] * np.exp(-way * wrap_of(rig) * nodes))
        np.testing.assert_allclose(frames.tension_N[k], along, atol=0.05)
        before, between = between, tensions[k] * np.exp(-way * wrap_of(rig) * middles)
        between = extreme(before, between)
        slid = between != before
        # A node at a front, of this stroke or an earlier one, slips or not.
        assert np.count_nonzero(frames.slip[k] != way * slid) <= k + 1
        assert frames.front[k] == pytest.approx(slid.mean(), abs=1.01 / n)


def test_a_slack_tendon_carries_nothing():
    x = np.concatenate((through(5.0, -40.0, -35.0), np.full(50, -35.0)))
    answer = simulate(GROUP_A, DriveInput(x), looked_at=np.arange(x.size))
    slack, frames = answer.phase == SLACK, answer.frames
    assert slack.sum() > 100
    assert not frames.tension_N[slack].any()
    assert not frames.front[slack].any()
    assert ((frames.slip == SLACK) == slack[:, None]).all()


def test_presliding_slips_where_its_bristles_are_at_their_limit():
    rig = GROUP_A._replace(effects=Effects(presliding=Presliding(0.02)))
    pull, dead_band = through(20.0, samples=2000), np.linspace(20.0, 19.75, 501)[1:]
    frames = empty_frames(np.arange(2500), 60)
    phase = chain(np.concatenate((pull, dead_band)), rig, frames).phase
    assert (frames.slip[phase == 1] == 1).all()
    turned, front = frames.slip[-500:], frames.front[-500:]
    assert (turned[:5] != -1).all()  # the bristles turn round first
    assert (turned[-1] == -1).any()
    assert (np.diff(front[(turned[:, 0] == -1)]) >= 0.0).all()


@pytest.mark.parametrize("dynamics", ["static", "lugre"])
def test_other_models_do_not_say_it(dynamics):
    with pytest.raises(ValueError, match=f"'{dynamics}'; expected 'slip'"):
        simulate(GROUP_A, DriveInput(SINE, time_s=TIME_S), dynamics, looked_at=np.array([0, 10]))


def test_the_front_is_where_slip_changes_first():
    frames = empty_frames(np.array([4, 6, 9, 12]), 4)
    frames.slip[:3] = [[1, 1, 0, 1], [-1, -1, -1, -1], [0, 1, 1, 1]]
    frames.slip[3] = SLACK
    assert [slips_up_to(frames, k) for k in range(4)] == [0.5, 1.0, 0.0, 0.0]
    assert [is_next(frames, k, 6) for k in range(5)] == [False, True, False, False, False]


def test_what_no_solver_has_reached_is_unknown():
    frames = empty_frames(np.array([3, 5]), 4)
    assert np.isnan(frames.tension_N).all()
    assert (frames.slip == UNCONVERGED).all()
    np.testing.assert_allclose(frames.places, [0.0, 0.25, 0.5, 0.75, 1.0])
