"""What is along the tendon: every solver against its own ends, the chain by the closed form."""

import numpy as np
import pytest

from tests.physics.references import (
    FREE,
    GROUP_A,
    LOADED_BY_SPRING,
    branches,
    course_of,
    slip_chain,
    through,
)
from tsas_cli.effects import Effects, Presliding
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.frames import empty_frames, is_next, slips_up_to
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import NODES, simulate

NESTED = through(20.0, 5.0, 15.0, 8.0, 11.0, 8.0, 15.0, 5.0, 20.0, 19.9, 19.95, 19.8, 0.0)
TIME_S = np.arange(0.0, 6.3, 1e-3)
SINE = 10.0 - 10.0 * np.cos(TIME_S)


def chain(x, rig, frames):
    return slip_chain(course_of(x, rig), rig, LOADED_BY_SPRING, frames.slip.shape[1], frames)


@pytest.mark.parametrize(
    ("solver", "call"),
    [
        ("closed form", {}),
        ("slip chain", {"nodes": NODES}),
        ("LuGre chain", {"dynamics": "lugre"}),
    ],
)
def test_ends_of_the_profile_are_those_of_the_same_simulation(solver, call):
    drive = DriveInput(SINE, time_s=TIME_S, start_f_in_N=30.0)
    at = np.arange(0, SINE.size, 7)
    answer = simulate(GROUP_A, drive, looked_at=at, **call)
    assert answer.solver.startswith(solver)
    frames = answer.frames
    np.testing.assert_array_equal(frames.samples, at)
    np.testing.assert_allclose(frames.tension_N[:, 0], answer.f_in_N[at], rtol=1e-12)
    np.testing.assert_allclose(frames.tension_N[:, -1], answer.f_out_N[at], rtol=1e-12)
    assert np.ptp(answer.f_in_N - answer.f_out_N) > 20.0  # the ends are not each other's
    plain = simulate(GROUP_A, drive, **call)
    np.testing.assert_array_equal(plain.f_in_N, answer.f_in_N)  # looking changes nothing
    np.testing.assert_array_equal(plain.phase, answer.phase)
    assert plain.frames is None


@pytest.mark.parametrize("rig", [GROUP_A, FREE])
def test_chain_and_closed_form_agree_along_the_tendon(rig):
    exact, found = (empty_frames(np.arange(0, NESTED.size, 3), 100) for _ in range(2))
    branches(NESTED, rig, exact)
    chain(NESTED, rig, found)
    assert np.abs(found.tension_N - exact.tension_N).max() < 0.5
    assert np.sqrt(np.mean((found.tension_N - exact.tension_N) ** 2)) < 0.02
    assert (found.slip != exact.slip).mean() < 0.01
    assert np.abs(found.front - exact.front).max() < 0.03


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
@pytest.mark.parametrize("nodes", [None, 60])
def test_a_slack_tendon_carries_nothing(dynamics, nodes):
    x = np.concatenate((through(5.0, -40.0, -35.0), np.full(50, -35.0)))
    drive = DriveInput(x, time_s=1e-2 * np.arange(x.size))
    answer = simulate(GROUP_A, drive, dynamics, nodes=nodes, looked_at=np.arange(x.size))
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


def test_the_lumped_model_does_not_say_it():
    answer = simulate(GROUP_A, DriveInput(SINE), "static", looked_at=np.array([0, 10]))
    assert answer.frames is None


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
