"""The sentences that give the reason of a verdict."""

from dataclasses import replace

import pytest

from tsas_cli.diagnosis.channel_errors import HeldOutErrors
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.reason import reason_of
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate

TITLE = {e.name: e.title.lower() for e in EFFECTS}
PLAY, MASS, FREE = "backlash", "load_inertia", "free_tendon"
START = {
    "f_in_N": HeldOutErrors(0.4, 0.12, 0.1, 0.11),
    "x_out_mm": HeldOutErrors(0.03, 0.03, 0.01, 0.02),  # the smaller one over its noise level
}


def cause(effect, rivals=(), failed=(), law=""):
    return FoundCause(effect, rivals, (), 50.0, (49.0, 51.0), failed, law)


def left(mean_square, *signals, **more):
    return Remainder(mean_square, {"f_in_N": 1.0} if signals else {}, signals, **more)


def test_a_complete_nominal_model_lacks_nothing():
    said = reason_of("sufficient", [], [], START, left(1.0))
    assert said == "The nominal model is at the noise level: these runs show no missing effect."


def test_a_nominal_model_within_tolerances_is_not_said_to_be_at_the_noise():
    said = reason_of("sufficient", [], [], START, left(4.0))
    assert said == (
        "The nominal model leaves 2.0 × the noise level: no more than slow noise and the "
        "tolerances of load cells, bend and friction do. These runs show no missing effect."
    )


def test_what_no_effect_explains_is_said_with_what_it_depends_on():
    after = left(16.0, "time_s", "x_in_mm", late=("x_out_mm",))
    assert reason_of("unexplained", [], [], START, after) == (
        "The RMS of the residual of f_in_N on held-out data is 0.400 N, and no catalogued effect "
        "explains it. "
        "It depends on the time in the run and the displacement of the drive. "
        "At each reversal x_out_mm lags behind the model, or leads it."
    )


@pytest.mark.parametrize(
    ("found", "near"), [(Reduction(0.36, 2.5), True), (Reduction(0.09, 2.5), False)]
)
def test_where_nothing_is_named_the_nearest_effect_is_said(found, near):
    nearest = f"{TITLE[PLAY].capitalize()} comes nearest: alone it takes 20 % off it, which is not"
    for stand_ins, said in (([], near), ([cause(MASS, failed=("is rare",))], False)):
        reason = reason_of("unexplained", [], stand_ins, START, left(9.0), None, (PLAY, found))
        assert (nearest in reason) == said
        assert ("nearest" in reason) == said


def test_causes_are_named_with_their_reduction():
    said = reason_of("named", [cause(PLAY), cause(MASS)], [], START, left(1.1))
    assert said == (
        f"The nominal model lacks: {TITLE[PLAY]} and {TITLE[MASS]}. "
        "With them the RMS of the residual of f_in_N on held-out data falls from 0.400 to 0.120 N."
    )


def test_what_tolerances_may_do_beside_named_causes_is_said():
    within = (
        "What is left, 2.0 × the noise level, is no more than slow noise and the tolerances of "
        "load cells, bend and friction do."
    )
    assert reason_of("named", [cause(PLAY)], [], START, left(4.0)).endswith(within)
    beside = reason_of("partly", [cause(PLAY)], [cause(MASS, failed=("fails",))], START, left(4.0))
    assert beside.endswith(within.replace("left,", "left without it,"))
    more = reason_of("partly", [cause(PLAY)], [], START, left(4.0, "time_s"))
    assert within not in more


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (1.04, 1.0, "from 1.04 to 1.00"),
        (1.004, 1.0, "from 1.004 to 1.000"),
        (1.0004, 1.0, "from 1.0004 to 1.0000"),
        (250.0, 1.0, "from 250 to 1.00"),
    ],
)
def test_a_small_reduction_is_not_from_one_number_to_the_same(before, after, words):
    channels = {"f_in_N": HeldOutErrors(before, after, 0.1, 0.1)}
    said = reason_of("named", [cause(PLAY)], [], channels, left(1.0))
    assert f"With it the RMS of the residual of f_in_N on held-out data falls {words} N." in said


def test_each_cause_is_said_with_its_rivals():
    causes = [cause(PLAY, (MASS, FREE)), cause("presliding", (MASS,)), cause("viscous_friction")]
    said = reason_of("ambiguous", causes, [], START, left(1.0))
    assert said.endswith(
        f" These recordings do not distinguish {TITLE[PLAY]} from {TITLE[MASS]} or {TITLE[FREE]}. "
        f"These recordings do not distinguish {TITLE['presliding']} from {TITLE[MASS]}."
    )


@pytest.mark.parametrize(("least", "alone"), [(-0.1, False), (0.1, True)])
def test_parameters_that_are_significant_together_only(least, alone):
    offsets = (
        Estimate("force_sensor_offset.f_in_offset_N", 2.0, "N", "fitted", None, 1.0, least, 4.0),
        Estimate("force_sensor_offset.f_out_offset_N", 0.6, "N", "fitted", None, 1.0, -2.4, 3.5),
    )
    found = replace(cause("force_sensor_offset"), parameters=offsets)
    said = reason_of("named", [found], [], START, left(1.0))
    assert ("No parameter of offset of a force sensor is significant alone" in said) != alone


def test_a_stand_in_is_said_with_what_it_fails_to_prove():
    stand_in = cause(PLAY, failed=("is not constant over the speed: 1 (low) and 2 (high) mm",))
    alone = reason_of("stand_in", [], [stand_in], START, left(16.0, "time_s"))
    assert alone.startswith("The RMS of the residual of f_in_N on held-out data is 0.400 N, and no")
    said = f"{TITLE[PLAY].capitalize()} takes 50 % off it, but is not proven: it is not constant"
    assert said in alone
    beside = reason_of("partly", [cause(MASS)], [stand_in], START, left(2.0))
    assert beside.startswith(f"The nominal model lacks: {TITLE[MASS]}.")
    assert said in beside


def test_what_several_stand_ins_fail_to_prove_is_said_once():
    left_over = "leaves 15 % of what could be explained"
    failing = [cause(PLAY, failed=(left_over,)), cause(MASS, failed=(left_over,))]
    said = reason_of("stand_in", [], failing, START, left(16.0, "time_s"))
    assert (
        f"and {TITLE[MASS]} take 50 and 50 % off it, but are not proven: each {left_over}" in said
    )
    assert said.count("not proven") == 1


def test_a_stand_in_takes_its_share_beside_those_that_were_left_out_after_it():
    failing = [cause(PLAY, failed=("fails",)), cause(MASS, failed=("is no more than a tolerance",))]
    said = reason_of("stand_in", [], failing, START, left(16.0, "time_s"))
    assert f"{TITLE[PLAY].capitalize()} takes 50 % off it beside {TITLE[MASS]}, but is not" in said
    assert f"{TITLE[MASS].capitalize()} takes 50 % off it, but is not" in said


def test_a_law_that_differs_is_said_of_its_effect():
    causes = [cause(MASS, law="over the speed: mass_kg 1 (low) and 2 (high) kg")]
    said = reason_of("partly", causes, [], START, left(2.0, "time_s"))
    assert f"The law of {TITLE[MASS]} differs from the catalogue's over the speed: mass" in said
    assert said.endswith(
        " No catalogued effect explains the remaining residual. It depends on the time in the run."
    )


@pytest.mark.parametrize(
    ("rms", "text"),
    [
        *((1.0, "1.00"), (1.004, "1.00"), (9.994, "9.99"), (9.996, "10.0"), (99.96, "100")),
        *((0.01234, "0.0123"), (1234.0, "1230")),
    ],
)
def test_the_residual_is_said_to_three_digits(rms, text):
    channels = {"x_out_mm": HeldOutErrors(rms, rms, 0.1, 0.1)}
    said = reason_of("unexplained", [], [], channels, left(1.0, "time_s"))
    assert said.startswith(f"The RMS of the residual of x_out_mm on held-out data is {text} mm,")


def test_three_causes_are_a_list():
    said = reason_of("named", [cause(PLAY), cause(MASS), cause(FREE)], [], START, left(1.44))
    assert f"{TITLE[PLAY]}, {TITLE[MASS]} and {TITLE[FREE]}." in said


def test_brief_errors_are_said():
    said = reason_of("unexplained", [], [], START, left(1.3, brief=("f_in_N",)))
    assert said.endswith("The channel f_in_N deviates from the model at a few moments of a run.")
    said = reason_of("unexplained", [], [], START, left(1.3, brief=("f_in_N", "x_out_mm")))
    assert said.endswith(
        "The channels f_in_N and x_out_mm deviate from the model at a few moments of a run."
    )
