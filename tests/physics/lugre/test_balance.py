"""Limits of friction at a lump, and what a step does not see of its input."""

import numpy as np
import pytest

from tests.physics.references import (
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    bare_step,
    course_of,
    step_ends,
)
from tsas_cli.physics.lugre.balance import set_limits
from tsas_cli.physics.lugre.ends import Samples, Span, input_error
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.lugre.state import DEFLECTION_HISTORY, LIMIT, LIMIT_BY_T, LIMIT_BY_V, RATE
from tsas_cli.physics.lugre.state import PITCH as LUGRE_PITCH
from tsas_cli.physics.lugre.state import ROWS as LUGRE_ROWS
from tsas_cli.physics.lugre.state import TENSION as LUMP_TENSION
from tsas_cli.physics.rig import with_values

RISING = "load_dependent_friction.exponent"
N = 3


def limits(rig, *, bristles=(1.0, -1.0, 1.0), speeds=(0.0, 0.0, 0.0), **other):
    s = np.zeros(LUGRE_ROWS * LUGRE_PITCH)
    F0 = rig.preload_N
    s[LUMP_TENSION : LUMP_TENSION + N + 1] = [2.0 * F0, 2.0 * F0, F0, -4.0 * F0]
    s[DEFLECTION_HISTORY + 1 : DEFLECTION_HISTORY + N + 1] = bristles
    s[RATE + 1 : RATE + N + 1] = speeds
    step = bare_step(gh=0.1, pulled=0.2, released=0.1, **other)
    set_limits(s, step, lugre_laws(rig, N, LOADED_BY_SPRING))
    rows = (LIMIT, LIMIT_BY_T, LIMIT_BY_V)
    assert not any(s[row] or s[row + N + 1] for row in rows)  # an end has a limit of its own
    return [s[row + 1 : row + N + 1] for row in rows]


@pytest.mark.parametrize("exponent", [0.0, 0.5, -0.5, 1.0, -1.0])
def test_limits_of_friction_follow_the_mean_tension(exponent):
    """c T̄ (T̄/F0)^n, by the direction of the bristles; its slope over T̄ is (n + 1) times as much."""
    rig = with_values(GROUP_A, {RISING: exponent})
    mean = np.array([2.0, 1.5, -1.5])
    share = np.array([0.2, 0.1, -0.2]) * np.abs(mean) ** exponent
    found, by_tension, by_speed = limits(rig)
    np.testing.assert_allclose(found, share * mean * GROUP_A.preload_N, atol=1e-3)
    np.testing.assert_allclose(by_tension, share * (1.0 + exponent), atol=1e-12)
    assert not by_speed.any()


def test_bristles_are_taken_where_the_step_brings_them():
    """At rest before: by the speeds, of the frame too, over 0.1 s."""
    found, *_ = limits(GROUP_A, bristles=(0.0, 0.0, 0.3), speeds=(1.0, -3.0, -6.0), speed=2.0)
    share = np.array([0.2, 0.1, -0.1])
    np.testing.assert_allclose(
        found, share * np.array([2.0, 1.5, -1.5]) * GROUP_A.preload_N, atol=1e-3
    )


def test_friction_at_rest_is_higher_where_stribeck_says_so():
    """Held against its own slope: a difference over the speed."""
    values = {"excess": 0.5, "velocity_mm_per_s": 2.0}
    rig = with_values(GROUP_A, {f"stribeck_friction.{n}": v for n, v in values.items()})
    still, *_ = limits(rig)
    plain, *_ = limits(GROUP_A)
    np.testing.assert_allclose(still, 1.5 * plain)
    moving, _, slope = limits(rig, speed=1.0)
    faster, *_ = limits(rig, speed=1.0 + 1e-6)
    np.testing.assert_allclose(slope, (faster - moving) / 1e-6, rtol=1e-4)
    assert (np.abs(moving) < np.abs(still)).all()


TIMES = np.arange(9.0)


def unseen_of(drive, load, boundary):
    course = course_of(drive, GROUP_A, load=load, time_s=TIMES)
    law, within = lugre_laws(GROUP_A, N, boundary), Samples(1, 8)
    return input_error(course, within, Span(0.0, 8.0), step_ends(), bare_step(), (3.0, 5.0), law)


def test_a_step_does_not_see_what_happens_within_it():
    """A bump of 2 in the middle of drive and load, where it saw nothing: 3 · 2 and 5 · 2 N."""
    bump, flat = 2.0 * (TIMES >= 1.0) * (TIMES < 8.0), np.zeros(9)
    assert unseen_of(bump, flat, LOADED_BY_SPRING) == pytest.approx(6.0)
    assert unseen_of(flat, bump, LOADED_BY_SPRING) == 0.0  # a spring is not given
    assert unseen_of(flat, bump, LOADED_BY_FORCE) == pytest.approx(10.0)
    assert unseen_of(bump, bump, LOADED_BY_DISPLACEMENT) == pytest.approx(16.0)
