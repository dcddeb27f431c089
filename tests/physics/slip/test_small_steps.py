"""How samples of the slip chain follow each other, how a run begins, and what it says."""

import math

import numpy as np
import pytest

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    course_of,
    follow,
    slip_chain,
)
from tests.physics.slip.laws_by_hand import SPRINGY
from tsas_cli.physics.course import Losses
from tsas_cli.physics.frames import empty_frames
from tsas_cli.physics.mesh import segment_compliances
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip import state as rows
from tsas_cli.physics.slip.chain import ChainEnds, go_slack, initial_state, rest_after
from tsas_cli.physics.slip.chain import follow as go_on
from tsas_cli.physics.slip.chain import moment as moment_of
from tsas_cli.physics.slip.outputs import phase_of, tension_at_sensor
from tsas_cli.physics.slip.state import Moment, chain_at_rest, slip_laws

F0, KL = 25.0, 1.579
NOW = Moment(0.9, 0.4, Losses(0.6, 0.45, 1.2, 2.0), math.inf)
AT_ENDS = {
    "drive_friction.friction_N": 2.0,
    "proximal_spring.stiffness_N_per_mm": 4.0,
    "load_friction.before_sensor_N": 1.5,
    "load_friction.after_sensor_N": 3.0,
}
PAIR = with_values(GROUP_A, {"antagonist.preload_N": 18.0})


def row(chain, at):
    return chain[at : at + 5]


def test_a_load_that_its_guide_holds_does_not_move_at_all():
    """Not by rounding either: what it reads stands still."""
    rig = with_values(GROUP_A, {"load_friction.after_sensor_N": 3.0})
    slowly, far = np.linspace(2.99, 2.95, 5), np.linspace(2.9, -4.0, 40)
    motion = np.concatenate((np.linspace(0.0, 3.0, 31), slowly, far))
    x_out = follow(motion, rig=rig, n=3)[1]
    assert x_out[30] > 0.5
    assert set(x_out[31:36].tolist()) == {x_out[30]}
    assert x_out[-1] < x_out[30] - 0.1


@pytest.mark.parametrize(
    ("slips", "phase"),
    [
        *(((1, 1, 1), 1), ((-1, -1, -1), -1), ((0, 0, 0), 0)),
        *(((1, 1, 0), 0), ((0, 1, 1), 0), ((1, -1, 1), 0)),
    ],
)
def test_the_phase_is_that_in_which_all_nodes_are(slips, phase):
    """What the ends do does not count."""
    chain = chain_at_rest(GROUP_A, 3)
    row(chain, rows.SLIP)[:] = 5.0, *slips, 7.0
    assert phase_of(chain, slip_laws(GROUP_A, 3, LOADED_BY_SPRING)) == phase


def test_the_phase_of_a_pair_is_that_of_both_unless_one_is_slack():
    chain = chain_at_rest(PAIR, 3)
    for first, second, slack, phase in (
        *(((1, 1, 1), (1, 1, 1), (0, 0), 1), ((-1, -1, -1), (-1, -1, -1), (0, 0), -1)),
        *(((1, 1, 1), (1, 0, 1), (0, 0), 0), ((1, 1, 1), (1, 1, 0), (0, 0), 0)),
        *(((1, 1, 1), (0, 1, 1), (0, 1), 1), ((1, 1, 1), (0, 1, 1), (0, 0), 0)),
        *(((1, 1, 1), (1, 1, 1), (1, 0), SLACK), ((0, 0, 0), (0, 0, 0), (0, 0), 0)),
    ):
        row(chain, rows.SLIP)[1:4], row(chain, rows.SECOND + rows.SLIP)[1:4] = first, second
        chain[rows.FIRST_IS_SLACK], chain[rows.SECOND + rows.IS_SLACK] = slack
        assert phase_of(chain, slip_laws(PAIR, 3, LOADED_BY_SPRING)) == phase


def test_what_a_sensor_at_the_load_feels():
    """The guide's friction before it is taken off, by its share of the guide where that sticks."""
    rig = with_values(GROUP_A, AT_ENDS)
    laws, chain = slip_laws(rig, 3, LOADED_BY_SPRING), chain_at_rest(rig, 3)
    chain[rows.TENSION + 3], chain[rows.POSITION + 4], chain[rows.SLIP + 4] = 40.0, 2.0, -1.0
    assert tension_at_sensor(chain, NOW, at(laws, LOADED_BY_FORCE)) == NOW.load
    assert tension_at_sensor(chain, NOW, at(laws, LOADED_BY_DISPLACEMENT)) == 41.5
    held = 40.0 - (F0 - 2.0 + 2.0 * KL)
    felt = tension_at_sensor(chain, NOW, at(laws, LOADED_BY_SPRING))
    assert felt == pytest.approx(40.0 - held / 3.0)
    bare = slip_laws(with_values(rig, {"load_friction.before_sensor_N": 0.0}), 3, LOADED_BY_SPRING)
    assert tension_at_sensor(chain, NOW, at(bare, LOADED_BY_SPRING)) == 40.0
    assert tension_at_sensor(chain, NOW, at(bare, LOADED_BY_DISPLACEMENT)) == 40.0


@pytest.mark.parametrize("boundary", [LOADED_BY_SPRING, LOADED_BY_DISPLACEMENT])
def test_a_slack_tendon_is_straight_up_to_its_load(boundary):
    laws, chain = slip_laws(GROUP_A, 3, LOADED_BY_SPRING), chain_at_rest(GROUP_A, 3)
    x, T = row(chain, rows.POSITION), row(chain, rows.TENSION)
    x[:] = -40.0, 1.0, 2.0, 3.0, 0.4
    for each in (rows.SLIP, rows.SPEED_BEFORE, rows.SHARE_BEFORE, rows.TENSION_RISE):
        row(chain, each)[:] = -3.0
    go_slack(chain, NOW, at(laws, boundary))
    load = 0.4 if boundary is LOADED_BY_DISPLACEMENT else -(F0 - NOW.losses.preload_N) / KL
    gives = segment_compliances(GROUP_A, 3)
    np.testing.assert_allclose(x[1:], load - F0 * np.append(np.cumsum(gives[:0:-1])[::-1], 0.0))
    assert x[0] == -40.0  # where the drive is
    assert not T[:4].any()
    assert row(chain, rows.SLIP).tolist() == [-3.0, 1.0, 1.0, 1.0, 1.0]  # as the next pull finds it
    assert chain[rows.SPEED_BEFORE + 4] == 0.0
    assert row(chain, rows.SHARE_BEFORE).tolist() == [1.0] * 5
    assert not row(chain, rows.TENSION_RISE).any()
    np.testing.assert_array_equal(row(chain, rows.POSITION_BEFORE), x)
    np.testing.assert_array_equal(row(chain, rows.TENSION_BEFORE), T)


def test_segments_share_the_compliance_of_the_sheath_by_their_bend():
    """Half ones at both ends; length per angle 1 + s p + b (3p² − 1)/2 in their middles."""
    rig = with_values(
        GROUP_A._replace(bend_slope=0.3, bend_bow=-0.2),
        {
            "free_tendon.proximal_length_mm": 40.0,
            "free_tendon.distal_length_mm": 15.0,
            "drive_compliance.compliance_mm_per_N": 0.004,
            "sheath_compression.compliance_ratio": 0.5,
        },
    )
    EA, L = GROUP_A.tendon_stiffness_N, GROUP_A.sheath_length_mm
    middles = np.array([-0.875, -0.5, 0.0, 0.5, 0.875])  # from −1 at the drive to 1 at the load
    shares = np.array([1, 2, 2, 2, 1]) / 8
    per_angle = 1.0 + 0.3 * middles - 0.2 * (1.5 * middles**2 - 0.5)
    expected = 1.5 * L / EA * shares * per_angle
    expected[0] += 40.0 / EA + 0.004
    expected[-1] += 15.0 / EA
    np.testing.assert_allclose(segment_compliances(rig, 4), expected)
    kept = chain_at_rest(rig, 4)[rows.COMPLIANCE :][:6]
    np.testing.assert_allclose(kept, [*expected, expected[-1]])


UP_AND_DOWN = np.array([0.4, 0.9, 1.6, 1.58, 1.45, 1.5, 0.3, -0.5, -25.0, -24.0, 2.0, 1.9])


WAVE = np.sin(np.arange(UP_AND_DOWN.size))
RUBBING, PAIR = with_values(GROUP_A, AT_ENDS), with_values(SPRINGY, {"antagonist.preload_N": 18.0})


@pytest.mark.parametrize(
    ("rig", "boundary", "drive", "load"),
    [
        (RUBBING, LOADED_BY_SPRING, UP_AND_DOWN, 0.0),
        (RUBBING, LOADED_BY_FORCE, UP_AND_DOWN, 27.0 + WAVE),
        (RUBBING, LOADED_BY_DISPLACEMENT, UP_AND_DOWN, 0.3 * WAVE),
        (RUBBING, DRIVEN_BY_FORCE, 25.0 + 0.8 * UP_AND_DOWN, 0.0),
        (PAIR, LOADED_BY_SPRING, 0.4 * UP_AND_DOWN, 0.0),
    ],
)
def test_a_run_may_be_followed_in_two_parts(rig, boundary, drive, load):
    """All that changes from outside is remembered, and both answers are one."""
    m = drive.size
    course = course_of(
        drive,
        rig,
        load=load,
        pulled=np.linspace(0.3, 0.6, m),
        released=np.linspace(0.5, 0.2, m),
        drag=np.linspace(0.5, 1.5, m),
        lost=np.linspace(0.0, 2.0, m),
        step=0.05,
    )
    whole = slip_chain(course, rig, boundary, 3)
    state, parts = initial_state(course, rig, boundary, 3), []
    for part in (course[:, :5].copy(), course[:, 5:].copy()):
        output, state = go_on(part, state, rig, boundary, 3, None)
        parts.append(output)
    for column, *pieces in zip(whole, *parts, strict=True):
        np.testing.assert_array_equal(np.concatenate(pieces), column)
    assert state.before == moment_of(course, m - 1)
    assert (*state.ends, state.unconverged) == (*(column[-1] for column in whole[:4]), 0)


@pytest.mark.parametrize(("unsettled", "given_up"), [(10, False), (11, True)])
def test_a_run_with_many_samples_that_did_not_settle_is_given_up(unsettled, given_up):
    course = course_of([0.4, 0.9], GROUP_A)
    state = initial_state(course, GROUP_A, LOADED_BY_SPRING, 3)
    state = state._replace(ends=ChainEnds(1.0, 2.0, 3.0, 4.0), unconverged=unsettled)
    frames = empty_frames(np.array([1]), 3)
    answer, state = go_on(course, state, GROUP_A, LOADED_BY_SPRING, 3, frames)
    assert state.unconverged == unsettled
    if given_up:
        for column, value in zip(answer, (1.0, 2.0, 3.0, 4.0, UNCONVERGED), strict=True):
            assert column.tolist() == [value, value]
        assert frames.slip.tolist() == [[UNCONVERGED] * 3]
    else:
        assert answer[0].tolist() == [0.4, 0.9]
        assert answer[4].tolist() == [1, 1]
        assert frames.slip.tolist() == [[1, 1, 1]]


def test_what_is_along_the_tendon_is_the_chains_state_at_that_sample():
    at = np.array([1, 3, 11])
    frames = empty_frames(at, 3)
    course = course_of(UP_AND_DOWN, GROUP_A)
    answer = slip_chain(course, GROUP_A, LOADED_BY_SPRING, 3, frames)
    for k, sample in enumerate(at):
        tensions = rest_after(course[:, : sample + 1], GROUP_A, LOADED_BY_SPRING, 3)[1]
        np.testing.assert_array_equal(frames.tension_N[k], tensions[:-1])
        assert frames.tension_N[k, 0] == answer[2][sample]
    assert frames.slip[:2].tolist() == [[1, 1, 1], [-1, 0, 0]]
    assert frames.front[:2].tolist() == [1.0, 1.0 / 3.0]
