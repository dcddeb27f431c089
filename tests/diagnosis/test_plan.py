"""What runs could show, held against what the laws of the effects say of these motions."""

import math

import numpy as np
import pytest

from tests.counted import Counted
from tests.diagnosis.planned import prepared, rig_file, run, seen
from tsas_cli.diagnosis import further_runs
from tsas_cli.diagnosis import plan as planning
from tsas_cli.diagnosis.candidates import candidates
from tsas_cli.diagnosis.plan import plan_rig, propose
from tsas_cli.effects import (
    CHANNEL_DELAY,
    DRIVE_FRICTION,
    EFFECTS,
    LOAD_FRICTION,
    LOAD_INERTIA,
    VISCOUS_FRICTION,
)
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.support.errors import InputError

INERTIA = "load_inertia.mass_kg"
PERIODS = 4  # 8 strokes: 7 are the least that is planned from
RATE_HZ = 30.0  # of a plan, which looks at further runs too
FEW = ("a fast sine", "fast ramps", "a long run")  # all: tests/commands/test_plan.py, large
VISCOUS = "viscous_friction.coefficient_N_s_per_mm"


@pytest.fixture(scope="module")
def slow():
    return seen(run(5.0))


@pytest.fixture(scope="module")
def few():
    """Consider few runs that might be added."""

    def made(*asked):
        return [one for one in candidates(*asked) if one.title in FEW]

    with pytest.MonkeyPatch.context() as patch:
        for module in (planning, further_runs):
            patch.setattr(module, "candidates", made)
        yield


@pytest.fixture(scope="module")
def plan(few):
    counted = Counted()
    planned = plan_rig(rig_file(run(5.0, periods=PERIODS), rate_Hz=RATE_HZ), counted)
    assert counted.all_of(least=2 + len(FEW))
    return planned


def test_a_mass_does_not_show_where_nothing_speeds_up():
    assert seen(run(1.0, periods=3), among=(LOAD_INERTIA,))[INERTIA].found == math.inf


def test_a_fast_run_shows_a_smaller_mass_and_less_viscosity(slow):
    both = seen(run(5.0), run(40.0, "b"), among=(LOAD_INERTIA, VISCOUS_FRICTION))
    assert both[INERTIA].found < 0.1 * slow[INERTIA].found
    assert both[VISCOUS].found < 0.5 * slow[VISCOUS].found


def test_two_speeds_tell_viscosity_from_friction_that_knows_no_speed():
    among = (DRIVE_FRICTION, LOAD_FRICTION, VISCOUS_FRICTION)
    first, second = run(10.0, motion="ramps"), run(20.0, "b", motion="ramps")
    one_speed, two = seen(first, among=among), seen(first, second, among=among)
    for rival in ("drive_friction", "load_friction"):
        assert one_speed[VISCOUS].distinct[rival] > 2.0 * one_speed[VISCOUS].found
        assert two[VISCOUS].distinct[rival] < 1.5 * two[VISCOUS].found


def test_what_the_free_parameters_do_themselves_is_not_shown(slow):
    """A soft sheath is a soft tendon; drift from session to session needs a second run."""
    assert slow["sheath_compression.compliance_ratio"].found == math.inf
    assert slow["friction_drift.session_rate_per_s"].found == math.inf


def test_a_free_tendon_at_the_drive_hides_in_a_soft_drive_and_the_other_way_round(slow):
    assert slow["free_tendon.proximal_length_mm"].hidden_in == ["drive_compliance"]
    assert "free_tendon" in slow["drive_compliance.compliance_mm_per_N"].hidden_in
    assert slow["drive_compliance.compliance_mm_per_N"].named == math.inf


def test_noise_of_a_channel_hides_what_that_channel_shows(slow):
    """Three times the noise of x_out: its delay must be three times as long, no other's."""
    noisy = seen(run(5.0), among=(CHANNEL_DELAY,), x_out_mm=0.03)
    ratio = {
        name: noisy[f"channel_delay.{name}_delay_s"].found
        / slow[f"channel_delay.{name}_delay_s"].found
        for name in ("x_out", "f_in", "f_out")
    }
    assert ratio == pytest.approx({"x_out": 3.0, "f_in": 1.0, "f_out": 1.0}, rel=0.25)


def test_a_play_is_found_from_a_part_of_the_noise_on(slow):
    """x_in is known to a hundredth of a millimetre per sample, and far better over a stroke."""
    assert 0.0005 < slow["backlash.play_mm"].found < 0.02


def test_a_plan_has_every_effect_and_the_pair(plan):
    assert {s.cause.effect.name for s in plan.seen} == {e.name for e in EFFECTS}
    assert ("drive_compliance", "free_tendon") in plan.groups


def test_proposals_stay_within_twice_the_speed_and_improve_what_they_say(plan):
    assert 0 < len(plan.proposals) <= 3
    scores = [p.score for p in plan.proposals]
    assert scores == sorted(scores, reverse=True)
    for proposal in plan.proposals:
        assert proposal.candidate.run.speed <= 10.0 + 1e-9
        assert proposal.candidate.run.amplitude_mm <= 10.0
        assert proposal.better
        assert all(b.after < b.before for b in proposal.better)


def test_what_a_proposal_promises_holds_when_it_is_planned(plan):
    """The run is planned too, with other noise: the sizes named are about the promised ones."""
    first = plan.proposals[0]
    with_it = seen(run(5.0, periods=PERIODS), first.candidate.run, rate_Hz=RATE_HZ)
    ratios = [with_it[b.cause.name].named / b.after for b in first.better]
    assert np.median(ratios) == pytest.approx(1.0, rel=0.3)
    assert np.mean([0.5 < r < 2.0 for r in ratios]) > 0.8


def test_the_run_that_tells_viscosity_from_friction_has_another_speed(few):
    manifest, runs = prepared(rig_file(run(10.0, motion="ramps")))
    segments = [segment(r) for r in runs]
    measured = [slopes_of(r, s) for r, s in zip(runs, segments, strict=True)]
    bench = bench_of(solve_fit(base_fit(data_sheet(manifest), runs, segments, measured)))
    assert propose(bench, bench.fit(), ("drive_friction", "viscous_friction")) is not None
    assert propose(bench, bench.fit(), ("drive_compliance", "free_tendon")) is None


@pytest.mark.large
def test_too_few_stretches_are_said():
    """One slow stroke and back: √7 standard deviations are the least that is more than 2.6."""
    short = plan_rig(rig_file(run(5.0, periods=1)))
    assert all(s.found == math.inf for s in short.seen)
    assert any("needs at least 7" in sentence for sentence in short.cannot_tell)


def test_a_run_too_short_to_move_the_load_is_refused():
    with pytest.raises(InputError, match="reaches full slip"):
        plan_rig(rig_file(run(1.0, amplitude_mm=0.02)))


def test_a_run_too_long_is_refused_before_it_is_made():
    with pytest.raises(InputError, match="more than 1000000 samples"):
        plan_rig(rig_file(run(1e-4)))
