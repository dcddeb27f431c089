"""When the front set off, and when it came through."""

import numpy as np

from tests.physics.references import GROUP_A, through
from tsas_cli.physics.closed_form.branches import branches
from tsas_cli.physics.passages import Passage, passages, turns


def test_one_for_each_stroke():
    x = through(20.0, 10.0, 15.0)
    *_, phase = branches(x, GROUP_A)
    found = passages(x, phase)
    assert [(one.direction, one.start) for one in found] == [(1, 0), (-1, 399), (1, 799)]
    for one in found:
        assert phase[one.arrived] == one.direction
        assert (phase[one.start + 1 : one.arrived] == 0).all()
    assert all(one.arrived > one.start + 5 for one in found[1:])


def test_a_stroke_within_the_dead_band_never_arrives():
    x = through(20.0, 19.95, 20.0)
    *_, phase = branches(x, GROUP_A)
    found = passages(x, phase)
    assert [one.direction for one in found] == [1, -1, 1]
    assert found[1].arrived is None
    assert found[0].arrived is not None


def test_the_dead_band_is_as_wide_as_the_source_says():
    """Table 3's parameters: F L (e^a + e^−a − 2)/(a EA), F the tension at the load."""
    x = np.concatenate((through(20.0), np.linspace(20.0, 19.0, 5001)[1:]))
    _, f_out, phase = branches(x, GROUP_A)
    down = passages(x, phase)[1]
    a = 0.125 * np.pi
    width = f_out[down.start] * 785.398 * (np.exp(a) + np.exp(-a) - 2.0) / (a * 67858.4)
    assert abs((x[down.start] - x[down.arrived]) - width) < 2e-4


def test_rests_and_no_motion():
    rest = np.array([0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 0.5, 1.5])
    np.testing.assert_array_equal(turns(rest), [0, 4, 7])
    np.testing.assert_array_equal(turns(np.array([0.0, 1.0, 1.0, 2.0])), [0])
    assert passages(np.ones(5), np.zeros(5, dtype=np.int8)) == []
    phase = np.array([0, 1, 1, 1, 1, 0, 0, -1, 0], dtype=np.int8)
    assert passages(rest, phase) == [Passage(1, 0, 1), Passage(-1, 4, 7), Passage(1, 7, None)]
