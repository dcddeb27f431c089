"""Which runs may be proposed, within what the rig can do."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.planned import run
from tests.physics.references import GROUP_A
from tsas_cli.diagnosis.candidates import (
    candidates,
    planned_limits,
    recorded_limits,
    within,
)
from tsas_cli.diagnosis.rig_file import Limits


def planned(run_id="a", speed_mm_per_s=8.0, **other):
    return run(speed_mm_per_s, run_id, **{"total_bend_rad": 3.0, "periods": 2} | other)


def test_without_limits_twice_the_speed_and_half_more_preload_are_plausible():
    runs = [planned(), planned("b", speed_mm_per_s=12.0, preload_N=40.0, total_bend_rad=1.5)]
    limits = planned_limits(runs)
    assert limits.amplitude_mm == 10.0
    assert limits.speed_mm_per_s == 24.0
    assert limits.preload_N == (25.0, 40.0, 60.0)
    assert limits.total_bend_rad == (1.5, 3.0)


def recorded(x, preload_N=25.0, bend=3.0, column="x_in_mm"):
    return SimpleNamespace(
        drive_column=column,
        drive=SimpleNamespace(values=np.asarray(x, dtype=float)),
        time_s=0.5 * np.arange(len(x)),
        run=SimpleNamespace(preload_N=preload_N, total_bend_rad=bend),
    )


def test_recorded_runs_say_what_the_rig_does():
    """Half of the largest stroke, twice the largest speed; a run driven by force says nothing."""
    runs = [
        recorded([0.0, 4.0, 8.0, 5.0]),
        recorded([0.0, -1.0, 0.0, 0.0], preload_N=None, bend=None),
        recorded([0.0, 900.0, 0.0], preload_N=99.0, column="f_in_N"),
    ]
    limits = recorded_limits(runs)
    assert limits.amplitude_mm == 4.0
    assert limits.speed_mm_per_s == 2.0 * 8.0
    assert limits.preload_N == (25.0, 37.5)
    assert limits.total_bend_rad == (3.0,)


def test_what_is_stated_goes_before_what_is_plausible():
    other = Limits(amplitude_mm=10.0, speed_mm_per_s=24.0, preload_N=(25.0,))
    both = within(Limits(speed_mm_per_s=9.0), other)
    assert (both.amplitude_mm, both.speed_mm_per_s, both.preload_N) == (10.0, 9.0, (25.0,))


LIMITS = Limits(
    amplitude_mm=10.0, speed_mm_per_s=24.0, preload_N=(20.0, 25.5), total_bend_rad=(1.5, 5.0)
)


def test_every_proposal_is_within_the_limits_and_varies_one_thing():
    found = candidates(LIMITS, GROUP_A, planned())
    titles = [c.title for c in found]
    assert len(set(titles)) == len(titles) == 11
    for c in found:
        assert 0.0 < c.run.amplitude_mm <= 10.0
        assert 0.0 < c.run.speed <= 24.0
        assert c.run.preload_N in (25.0, 20.0)
        assert c.run.periods >= 2
    assert [c.title for c in found if c.run.dwell_s] == ["a staircase with rests"]


def test_the_farthest_preload_and_bend_are_proposed():
    runs = {c.title: c.run for c in candidates(LIMITS, GROUP_A, planned())}
    assert runs["another preload"].preload_N == 20.0  # 5 N off, not half a newton
    assert runs["another bend"].total_bend_rad == 5.0
    assert runs["another preload"].total_bend_rad == GROUP_A.total_bend_rad
    assert runs["run a again"].speed == 8.0
    assert runs["run a again"].id == "proposed: a again"


def test_nothing_else_to_try_is_not_proposed():
    """A preload within a twentieth of the usual one is the usual one."""
    bare = Limits(amplitude_mm=10.0, speed_mm_per_s=24.0, preload_N=(25.0, 26.2))
    titles = [c.title for c in candidates(bare, GROUP_A)]
    assert not any("another" in title or "again" in title for title in titles)
    wider = bare.model_copy(update={"preload_N": (25.0, 26.3)})
    assert "another preload" in [c.title for c in candidates(wider, GROUP_A)]


def test_a_proposal_says_what_to_do():
    (stairs,) = [c for c in candidates(LIMITS, GROUP_A) if c.run.dwell_s]
    assert stairs.sentence == (
        "a staircase with rests: 2 times 0 to 20 mm and back at up to 8 mm/s, 2 s of rest after "
        "each stroke, preload 25 N, bend 3.14 rad, sheath 785.4 mm"
    )
    (long,) = [c for c in candidates(LIMITS, GROUP_A) if c.title == "a long run"]
    assert "rest" not in long.sentence
    guessed = replace(stairs, assumed=frozenset({"total_bend_rad", "sheath_length_mm"})).sentence
    assert guessed == stairs.sentence.partition(", bend")[0]


@pytest.mark.parametrize(
    ("title", "motion", "share", "periods", "dwell_s", "amplitude_mm"),
    [
        ("a slow sine", "sine", 0.1, 2, 0.0, 10.0),
        ("a fast sine", "sine", 1.0, 6, 0.0, 10.0),
        ("fast ramps", "ramps", 1.0, 4, 0.0, 10.0),
        ("nested loops", "nested", 1.0 / 3.0, 2, 0.0, 10.0),
        ("short strokes", "sine", 1.0 / 3.0, 4, 0.0, 3.0),
        ("a staircase with rests", "steps", 1.0 / 3.0, 2, 2.0, 10.0),
        ("a chirp", "chirp", 1.0, 6, 0.0, 10.0),
        ("a long run", "sine", 1.0 / 3.0, 12, 0.0, 10.0),
        ("another preload", "sine", 1.0 / 3.0, 2, 0.0, 10.0),
        ("another bend", "sine", 1.0 / 3.0, 2, 0.0, 10.0),
    ],
)
def test_each_proposal_as_the_documents_list_it(
    title, motion, share, periods, dwell_s, amplitude_mm
):
    (run,) = [c.run for c in candidates(LIMITS, GROUP_A) if c.title == title]
    assert (run.motion, run.periods, run.dwell_s) == (motion, periods, dwell_s)
    assert run.speed == pytest.approx(24.0 * share)
    assert run.amplitude_mm == pytest.approx(amplitude_mm)
    assert run.sheath_length_mm == GROUP_A.sheath_length_mm


def test_without_any_limit_a_millimetre_and_a_millimetre_per_second_are_meant():
    fast = {c.title: c.run for c in candidates(Limits(), GROUP_A)}["a fast sine"]
    assert (fast.amplitude_mm, fast.speed) == (1.0, 1.0)


def test_bends_of_a_straight_rig_are_other_ones():
    straight = GROUP_A._replace(total_bend_rad=0.0)
    bent = Limits(amplitude_mm=1.0, speed_mm_per_s=1.0, total_bend_rad=(0.0, 0.001))
    runs = {c.title: c.run for c in candidates(bent, straight)}
    assert runs["another bend"].total_bend_rad == 0.001


def test_runs_without_a_preload_say_nothing_of_it():
    limits = recorded_limits([recorded([0.0, 3.0], preload_N=None, bend=None)])
    assert (limits.preload_N, limits.total_bend_rad) == ((), ())
    straight = recorded_limits([recorded([0.0, 3.0], preload_N=0.0, bend=0.0)])
    assert (straight.preload_N, straight.total_bend_rad) == ((), (0.0,))
