"""A plan as JSON and as tables."""

import math

import pytest

from tests.diagnosis.sizes import CANDIDATES, LENGTH, MASS, OF, PLAY, better, seen
from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility, amplitudes_of
from tsas_cli.diagnosis.plan import ExperimentPlan, FurtherRun
from tsas_cli.stages import plan as plan_stage

HIDDEN = ExperimentPlan(
    (
        seen(PLAY, 0.01234, load_inertia=0.05),
        seen(MASS, 0.5, free_tendon=6.0, backlash=1.0),
        seen(LENGTH, math.inf),
    ),
    ((LENGTH, MASS),),
    (
        FurtherRun(
            CANDIDATES[0],
            math.log(4.0),
            (*(better(PLAY, 0.4, 0.1) for _ in range(5)), better(MASS, math.inf, 0.3)),
            (),
        ),
    ),
    ("nobody knows.",),
)


def tables(found):
    record = plan_stage.record_of(found)
    return list(plan_stage.PlanResult({}, None, record, found).tables())


def test_a_plan_as_json():
    found = plan_stage.record_of(HIDDEN)
    first, second, third = found.effects
    assert (first.effect, first.parameter, first.unit) == (PLAY, "play_mm", "mm")
    assert (first.found_from, first.named_from) == (0.01234, 0.05)
    assert (first.nearest, first.hidden_in) == (MASS, ())
    assert second.hidden_in == (LENGTH,)
    assert (third.found_from, third.named_from, third.nearest) == (None, None, None)
    assert found.groups == ((LENGTH, MASS),)
    (proposal,) = found.proposals
    assert proposal.falls_percent == pytest.approx(75.0)
    run = proposal.content()["run"]
    assert "id" not in run
    assert "frequency_Hz" not in run
    assert proposal.better[0].named_from_with_it == 0.1
    assert proposal.better[-1].named_from is None
    assert found.cannot_tell == ("nobody knows.",)


def test_a_size_that_is_found_however_small_is_any():
    """The preload of a second tendon: it pulls when the drive goes back, however slack it was."""
    (cause,) = (c for c in amplitudes_of(OF["antagonist"]) if c.shape["antagonist.f_in_share"])
    found = ExperimentPlan((Visibility(cause, 1e-5, {}),), (), (), ())
    record = plan_stage.record_of(found)
    assert (record.effects[0].found_from, record.effects[0].named_from) == (0.0, 0.0)
    (sizes,) = tables(found)
    assert sizes[2][0][3:5] == ("any", "any")


def test_shapes_are_named_within_their_effect():
    shaped = Visibility(
        Amplitude(OF[PLAY], OF[PLAY].parameters[0], {"backlash.kind": 2.0}), 1.0, {}
    )
    found = plan_stage.record_of(ExperimentPlan((shaped,), (), (), ())).effects[0]
    assert found.shape == {"kind": 2.0}


def test_the_tables_of_a_plan():
    sizes, groups, proposal = tables(HIDDEN)
    assert [row[3:] for row in sizes[2]] == [
        ("0.012", "0.05", MASS),
        ("0.5", "6", LENGTH),
        ("not shown", "", ""),
    ]
    assert groups[2] == ((LENGTH, MASS),)
    title, header, rows = proposal
    assert title.endswith(": sizes fall by 75 % on average")
    assert title.startswith("add a slow sine: 2 times")
    assert len(header) == 5
    assert len(rows) == 4  # no more are printed
    assert rows[0] == (PLAY, "play_mm", "mm", "0.4", "0.1")
    never = ExperimentPlan((seen(MASS, 0.5, backlash=math.inf),), (), (), ())
    (only,) = tables(never)
    assert only[2][0][3:] == ("0.5", "never", PLAY)
