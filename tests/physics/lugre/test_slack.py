"""A tendon that hangs in the dynamic chain."""

import numpy as np
import pytest

from tests.physics.lugre.lumps import LAST, cleared, segments
from tests.physics.lugre.test_pieces import ENDS, F0, KL, lumps
from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    course_of,
)
from tsas_cli.physics.course import DRIVE
from tsas_cli.physics.lugre import state as rows
from tsas_cli.physics.lugre.chain import has_gone_slack
from tsas_cli.physics.lugre.ends import Samples
from tsas_cli.physics.lugre.slack import (
    end_of_slack,
    is_slack,
    shortening,
    slack_state,
    unloaded_load,
    write_slack,
)
from tsas_cli.physics.phases import SLACK


def test_a_tendon_hangs_where_nothing_pulls_and_the_drive_is_too_near():
    s, law = lumps(GROUP_A)
    lost = 2.0
    straight = -(F0 - lost) / KL - F0 * GROUP_A.sheath_length_mm / GROUP_A.tendon_stiffness_N
    assert unloaded_load(lost, law) == pytest.approx(-(F0 - lost) / KL)
    assert shortening(s, law) == pytest.approx(-straight - (F0 - lost) / KL)
    pushed, pulled = (ENDS._replace(drive=ENDS.drive._replace(tension=f)) for f in (-1e-6, 0.0))

    def slack(off, ends=pushed, boundary=LOADED_BY_SPRING):
        course = course_of([straight + off] * 2, GROUP_A, lost=lost, time_s=[0.0, 1.0])
        return has_gone_slack(s, course, 1, 1.0, ends, at(law, boundary))

    assert slack(-1e-6)
    assert not slack(1e-6)
    assert not slack(-1e-6, ends=pulled)
    assert not slack(-1e-6, boundary=LOADED_BY_FORCE)


STRAIGHT = -F0 / KL - F0 * GROUP_A.sheath_length_mm / GROUP_A.tendon_stiffness_N


def written(course, law):
    """Return the columns and the phase of four samples, the inner two of a slack tendon."""
    columns, phase = np.full((4, 4), -1.0), np.zeros(4, dtype=np.int8)
    write_slack(columns, phase, Samples(1, 3), cleared(GROUP_A)[0], course, law)
    assert np.all(columns[:, [0, 3]] == -1.0)
    assert phase.tolist() == [0, SLACK, SLACK, 0]
    return columns[:, 1:3].tolist()


def test_a_slack_tendon_is_taken_up_where_the_drive_is_back_where_it_hangs_straight():
    """Between the samples, where the curve through them has the place; the load rests till then."""
    (s, law), times = lumps(GROUP_A), np.arange(4.0)
    course = course_of(STRAIGHT + times - 2.75, GROUP_A, time_s=times)
    for k, t in ((0, 0.2), (2, 2.5)):
        assert end_of_slack(s, course, k, t, law) == (2, pytest.approx(2.75, abs=1e-9))
    never = course_of([STRAIGHT - 1.0] * 4, GROUP_A, time_s=times)
    assert end_of_slack(s, never, 0, 0.2, law) == (3, 3.0)
    moved, rest = course[DRIVE, 1:3].tolist(), pytest.approx([-F0 / KL] * 2)
    assert written(course, law) == [moved, rest, [0.0, 0.0], [0.0, 0.0]]
    taut = slack_state(s, -3.0, law)
    np.testing.assert_allclose(np.diff(taut[0]), F0 / segments(s, rows.STIFFNESS))
    assert (taut[0, LAST], taut[1].any()) == (-3.0, False)


def test_a_drive_without_pull_lets_the_tendon_hang_and_goes_where_it_is_straight():
    s, law = lumps(GROUP_A)
    pull = course_of([3.0, 0.0, -2.0, 2.0], GROUP_A, time_s=np.arange(4.0))
    by_force, there = at(law, DRIVEN_BY_FORCE), at(law, LOADED_BY_DISPLACEMENT)
    slack = [is_slack(s, pull, min(k, 2), float(k), by_force) for k in range(4)]
    assert slack == [False, True, True, False]
    rest, straight = (pytest.approx([x, x]) for x in (-F0 / KL, STRAIGHT))
    assert written(pull, by_force) == [straight, rest, [0.0, -2.0], [0.0, 0.0]]
    for off, hangs in ((-1e-6, True), (1e-6, False)):
        near = 6.0 + STRAIGHT + F0 / KL + off  # half way from 5 to 7 mm
        course = course_of([near, near], GROUP_A, load=[5.0, 7.0], time_s=[0.0, 1.0])
        assert is_slack(s, course, 0, 0.5, there) == hangs
