"""The rig against the exact continuum with Coulomb friction (docstrings give the formulas)."""

import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.motions import Motion, clock, nested, sine, through
from tsas_studies.challenge.rig.tendon import Rig, simulate

RIG = Rig()
A = RIG.friction_coefficient * RIG.total_bend_rad
C = RIG.sheath_length_mm / (A * RIG.axial_stiffness)  # mm/N
KL, F0 = RIG.load_stiffness_N_per_mm, RIG.preload_N
DOWN, UP = math.exp(-A), math.exp(A)


@pytest.fixture(scope="module")
def group_a():
    return simulate(RIG, sine(rate_Hz=250.0)).columns


def full_slip(columns, *, pulling):
    """Samples of the second period well past the dead band."""
    t = columns["time_s"]
    return (t > 7.0) & (t < 9.0) if pulling else (t > 10.0) & (t < 12.0)


def band_after(columns, index, ratio):
    """From a turning point, the samples until f_in has gone to its value times the ratio."""
    f = columns["f_in_N"]
    passed = (f - f[index] * ratio) * (1.0 if ratio > 1.0 else -1.0) > 0.0
    end = index + int(np.argmax(passed[index:]))
    return slice(index, end)


def turning(columns, *, top):
    """The index of the turn at the top (t = π) or at the bottom (t = 2π) of the first period."""
    return int(np.argmin(np.abs(columns["time_s"] - (math.pi if top else 2.0 * math.pi))))


@pytest.mark.parametrize("pulling", [True, False])
def test_full_slip_obeys_capstan_and_hooke(group_a, pulling):
    w = full_slip(group_a, pulling=pulling)
    sign = 1.0 if pulling else -1.0
    ratio = math.exp(sign * A)
    stretch = sign * C * (ratio - 1.0)  # elongation per distal tension, mm/N
    rest = F0 * C * A
    f_out = (F0 + KL * (group_a["x_in_mm"][w] + rest)) / (1.0 + KL * stretch)
    assert np.sqrt(np.mean((group_a["f_out_N"][w] - f_out) ** 2)) < 1e-3
    assert np.sqrt(np.mean((group_a["f_in_N"][w] - ratio * f_out) ** 2)) < 1e-3


@pytest.mark.parametrize(("top", "ratio", "sign"), [(True, DOWN**2, -1.0), (False, UP**2, 1.0)])
def test_dead_band_follows_the_slip_front(group_a, top, ratio, sign):
    """T0 = T (1 ± sqrt(D / (C T)))² at D from a turning point with proximal tension T."""
    turn = turning(group_a, top=top)
    band = band_after(group_a, turn, ratio)
    x, f = group_a["x_in_mm"], group_a["f_in_N"]
    D = np.abs(x[band] - x[turn])
    exact = f[turn] * (1.0 + sign * np.sqrt(D / (C * f[turn]))) ** 2
    assert D.size > 25
    assert np.sqrt(np.mean((f[band] - exact) ** 2)) < 0.01


def test_the_distal_end_waits_in_the_dead_band(group_a):
    band = band_after(group_a, turning(group_a, top=True), 0.99 * DOWN)
    assert np.ptp(group_a["f_out_N"][band]) < 1e-6


def test_mesh_order_is_two():
    """Elongation in full slip, where the law of friction plays no part."""
    motion = through([5.0], rate_Hz=100.0)
    ends = [simulate(Rig(cells=n), motion).columns["f_in_N"][-1] for n in (20, 40, 80)]
    order = math.log2((ends[0] - ends[1]) / (ends[1] - ends[2]))
    assert order == pytest.approx(2.0, abs=0.1)


def test_return_point_memory():
    """An inner loop closes, and once it is closed it is forgotten."""
    rig = Rig(cells=60)
    columns = simulate(
        rig, through([20.0, 19.8, 19.9, 19.8, 19.5], speed_mm_s=0.5, rate_Hz=50.0)
    ).columns
    direct = simulate(rig, through([20.0, 19.5], speed_mm_s=0.5, rate_Hz=50.0)).columns
    arrivals = np.searchsorted(columns["time_s"], [40.4, 40.8])
    first, second = columns["f_in_N"][arrivals]
    assert columns["x_in_mm"][arrivals] == pytest.approx([19.8, 19.8])
    assert second == pytest.approx(first, abs=0.01)
    assert columns["f_in_N"][-1] == pytest.approx(direct["f_in_N"][-1], abs=0.01)
    halfway = np.searchsorted(columns["time_s"], 40.6)
    assert columns["f_in_N"][halfway] > first + 5.0


def test_nested_loops_come_back_to_the_outer_branch():
    columns = simulate(Rig(cells=60), nested(rate_Hz=100.0)).columns
    tops = np.flatnonzero(columns["x_in_mm"] > 20.0 - 1e-9)
    assert columns["f_in_N"][tops[-1]] == pytest.approx(columns["f_in_N"][tops[0]], abs=1e-6)


@pytest.mark.parametrize("distal_length_mm", [0.0, 60.0])
@pytest.mark.parametrize(("load", "channel"), [("force", "f_out_N"), ("displacement", "x_out_mm")])
def test_a_prescribed_distal_end_repeats_the_spring(load, channel, distal_length_mm):
    motion = sine(periods=1.0, rate_Hz=200.0)
    given = {"distal_length_mm": distal_length_mm, "cells": 60}
    spring = simulate(Rig(**given), motion).columns
    again = simulate(Rig(load=load, **given), motion, distal=spring[channel]).columns
    for name in spring:
        np.testing.assert_allclose(again[name], spring[name], atol=1e-5)


def test_where_the_bend_sits_changes_the_elongation_but_not_the_ratio():
    motion = through([10.0], rate_Hz=200.0)
    near = simulate(Rig(bend_profile=((0.0, 1.0), (0.02, 1.0), (0.021, 0.0))), motion).columns
    far = simulate(Rig(bend_profile=((0.979, 0.0), (0.98, 1.0), (1.0, 1.0))), motion).columns
    stretch = []
    for columns in (near, far):
        last = {name: values[-1] for name, values in columns.items()}
        assert last["f_in_N"] / last["f_out_N"] == pytest.approx(UP, rel=1e-4)
        elongation = last["x_in_mm"] - last["x_out_mm"]
        stretch.append(elongation * RIG.axial_stiffness / RIG.sheath_length_mm + F0)
    assert stretch[0] == pytest.approx(near["f_out_N"][-1], rel=0.01)
    assert stretch[1] == pytest.approx(far["f_in_N"][-1], rel=0.01)


def test_a_course_of_friction_over_time():
    motion = through([10.0], rate_Hz=200.0)
    more = simulate(Rig(friction_course=((0.0, 1.2),), cells=60), motion).columns
    plain = simulate(Rig(friction_coefficient=0.15, cells=60), motion).columns
    np.testing.assert_allclose(more["f_in_N"], plain["f_in_N"], atol=1e-6)


def test_friction_that_grows_while_nothing_moves_changes_nothing_but_the_next_pull():
    still = Motion(clock(4.0, 200.0), np.interp(clock(4.0, 200.0), [0, 2, 3, 4], [0, 10, 10, 11]))
    columns = simulate(Rig(friction_course=((2.0, 1.0), (3.0, 1.3)), cells=60), still).columns
    rest = (still.time_s > 2.0) & (still.time_s < 3.0)
    assert np.ptp(columns["f_out_N"][rest]) < 0.1
    assert columns["f_in_N"][-1] / columns["f_out_N"][-1] == pytest.approx(
        math.exp(1.3 * A), rel=1e-4
    )


def test_a_slack_tendon_is_refused():
    with pytest.raises(ValueError, match="slack at"):
        simulate(RIG, through([-30.0], rate_Hz=100.0))


@pytest.mark.parametrize(
    ("load", "distal"), [("spring", np.zeros(3)), ("force", None), ("magnet", np.zeros(3))]
)
def test_load_and_distal_values_must_fit(load, distal):
    with pytest.raises(ValueError, match="load"):
        simulate(Rig(load=load), Motion(np.arange(3.0), np.zeros(3)), distal=distal)
