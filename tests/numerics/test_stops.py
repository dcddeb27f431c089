"""Stop operators against their definition, and curves of straight lines."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tsas_cli.numerics.stops import (
    ELEMENTS,
    RATIO,
    beyond_gap,
    curve_of,
    states_of,
    widths_of,
    widths_with_gaps,
)

WIDTHS = np.array([1.0, 0.25])


def no_memory(elements=2):
    return np.full(1 + elements, np.nan)


def test_widths_fall_by_one_ratio_from_the_longest():
    widths = widths_of(2.0)
    assert widths.size == ELEMENTS
    assert widths[0] == 2.0
    assert widths[1:] / widths[:-1] == pytest.approx(RATIO)


def test_an_element_follows_its_width_and_yields():
    """Of width 1: up by 0.5 half way, at 1 it yields; back by 0.5 half way, by 2 all the way."""
    x = np.array([3.0, 3.5, 4.0, 9.0, 8.5, 7.0, 6.0])
    wide, narrow = states_of(x, WIDTHS, no_memory())
    assert wide == pytest.approx([0.0, 0.5, 1.0, 1.0, 0.5, -1.0, -1.0])
    assert narrow == pytest.approx([0.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0])


def test_a_signal_in_two_parts_has_the_states_of_the_whole():
    x = np.cumsum(np.random.default_rng(1).normal(0.0, 0.3, 200))
    memory = no_memory()
    parts = [states_of(part, WIDTHS, memory) for part in (x[:77], x[77:])]
    assert (np.hstack(parts) == states_of(x, WIDTHS, no_memory())).all()


@given(
    st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=12),
    st.lists(st.floats(0.0, 5.0), min_size=2, max_size=2),
)
def test_weights_that_are_not_negative_only_dissipate(corners, weights):
    """The work of a closed path from rest, back at its first place, is never negative."""
    path = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(corners)])
    path = np.concatenate((path, np.linspace(path[-1], path[0], 40)))
    force = np.array(weights) @ states_of(path, WIDTHS, no_memory())
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(path)))
    assert work >= -1e-9 * (1.0 + sum(weights))


@given(st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=8))
def test_elements_with_a_gap_only_dissipate(corners):
    """Up to the error of the sum, which is of the second order at the ends of the gap."""
    path = np.concatenate([np.linspace(a, b, 2000) for a, b in pairwise([*corners, corners[0]])])
    force = beyond_gap(states_of(path, WIDTHS, no_memory()))
    work = np.sum(0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(path), axis=1)
    assert (work >= -1e-4).all()


def test_the_spring_of_an_element_with_a_gap_is_loose_over_half_of_its_width():
    assert beyond_gap(np.array([-1.0, -0.75, -0.5, 0.0, 0.4, 0.75, 1.0])) == pytest.approx(
        [-1.0, -0.5, 0.0, 0.0, 0.0, 0.5, 1.0]
    )
    assert widths_with_gaps(8.0) == pytest.approx([8.0, 4.0, 2.0, 1.0])


def test_a_curve_is_straight_between_its_heights_and_constant_outside():
    x = np.array([-9.0, 0.0, 0.5, 1.0, 1.75, 2.0, 9.0])
    expected = [1.0, 1.0, 2.0, 3.0, -1.5, -3.0, -3.0]
    assert curve_of(x, 0.0, 2.0, (1.0, 3.0, -3.0)) == pytest.approx(expected)
    assert np.isnan(curve_of(np.array([np.nan]), 0.0, 2.0, (1.0, 3.0, -3.0))).all()
