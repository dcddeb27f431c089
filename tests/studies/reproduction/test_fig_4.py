"""Fig. 4: the four groups by every model."""

import math
from functools import cache

import numpy as np
import pytest

from tests.physics.references import Profile
from tsas_cli.paper import yang2025
from tsas_studies.reproduction.fig_4 import fig_4
from tsas_studies.reproduction.fig_4_runs import AT_P_RAD, effect_of_mass, runs_of
from tsas_studies.reproduction.rig import quasi_static_rig

PAPER = yang2025()


@cache
def runs(name):
    return runs_of(PAPER, name)


@cache
def group():
    return fig_4(PAPER)


def verdicts(start):
    return {row.what[6]: row.verdict for row in group().rows if row.what[7:].startswith(start)}


@pytest.mark.parametrize("name", ["a", *(pytest.param(n, marks=pytest.mark.large) for n in "cd")])
def test_f_in_at_p_is_that_of_a_profile_of_tensions(name):
    """P is found again by lowering a profile's tension until the drive is back by as much."""
    profile = Profile(quasi_static_rig(PAPER, name))
    tension = 25.0
    while profile.x_in < 20.0:
        tension += 0.02
        profile.pull_drive_to(tension)
    at_p = profile.x_in - 10.0 * (1.0 - math.cos(AT_P_RAD))
    while profile.x_in > at_p:
        tension -= 0.02
        profile.pull_drive_to(tension)
    assert runs(name).f_in_at_p("slip") == pytest.approx(tension, abs=0.1)


def test_static_and_dynamic_differ_where_the_band_is_curved():
    found = runs("a")
    off = found.difference("static", "fine", "f_in_N")
    assert off.largest == pytest.approx(19.2, abs=0.5)
    assert found.difference("static", "fine", "f_in_N", outside=True).rms < 0.1 * off.rms
    assert found.difference("fine", "fine", "f_in_N").largest == 0.0
    assert found.difference("dynamic", "fine", "f_in_N").largest < 0.05


def test_statements_about_similar_curves():
    assert verdicts(": static and dynamic model give a similar x_out") == dict.fromkeys(
        "abcd", "agrees"
    )
    assert verdicts(": static and dynamic model give a similar f_in") == dict.fromkeys(
        "abcd", "differs"
    )


def test_group_b_alone_has_no_stable_sliding_as_printed():
    stable = verdicts(": steady sliding is stable")
    assert stable == {"a": "agrees", "b": "differs", "c": "agrees", "d": "agrees"}
    slower = PAPER.with_value("groups.b.angular_frequency", 1.0)
    assert runs_of(slower, "b").diverging is None


def test_the_bristles_chatter_in_a_dead_band_as_printed_and_not_when_critical():
    assert runs("a").chattering.growth_per_s > 1e5
    assert not runs("a").chattering.moment.whole
    critical = PAPER.with_value("rig.micro_damping", 0.004)
    assert runs_of(critical, "a").unstable == ()


def test_what_has_no_printed_number_is_not_judged():
    for row in group().rows:
        if "at P" in row.what:
            assert (row.verdict, row.paper) == ("cannot tell", None)


def test_mass_plays_no_part_while_bristles_do():
    assert effect_of_mass(PAPER, "a") < 0.01
    found = runs("a")
    assert found.f_in_at_p("dynamic") - found.f_in_at_p("slip") == pytest.approx(0.8, abs=0.2)


def test_curves_are_drawn_of_each_group_and_none_that_has_no_solution():
    figures = group().figures
    assert {figure.part for figure in figures} == {f"Group {name}" for name in "abcd"}
    assert len({figure.key for figure in figures}) == len(figures)
    near = {figure.part[-1]: figure for figure in figures if figure.key.endswith("-p")}
    for name, figure in near.items():
        labels = [line.label for line in figure.lines]
        assert ("dynamic as printed" in labels) == (name != "b")
        assert all(np.isfinite(line.y).all() for line in figure.lines)
