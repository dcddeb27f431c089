"""Every class, by hand."""

import pytest

from tests.studies.challenge.made import case, described, diagnosis, estimate, named
from tsas_studies.challenge.entry import SubmittedDiagnosis
from tsas_studies.challenge.judge import Judged
from tsas_studies.challenge.truth import TrueCase


def judged(truth, said):
    return Judged(TrueCase.model_validate(truth), said and SubmittedDiagnosis.model_validate(said))


ONE, PAIR, NOTHING = case("backlash"), case("backlash", "drive_friction"), case()
UNKNOWN = case(unknown="rough_spot")
TRIPLE = case("backlash", "drive_friction", "presliding")
NEAR = case(kind="near", unknown="pulley_friction")
MIXED = case(
    kind="near", unknown="mixed", unknown_parameters={"pulley_friction": {}, "encoder_play": {}}
)
RIVAL = named("free_tendon", "backlash")


@pytest.mark.parametrize(
    ("truth", "said", "outcome", "false"),
    [
        (ONE, diagnosis("backlash"), "exact", set()),
        (ONE, diagnosis(named("backlash", "free_tendon"), verdict="ambiguous"), "exact", set()),
        (ONE, diagnosis(RIVAL, verdict="ambiguous"), "rivals", set()),
        (ONE, diagnosis("backlash", RIVAL), "rivals", set()),
        (ONE, diagnosis("backlash", "drive_friction"), "false", {"drive_friction"}),
        (ONE, diagnosis(named("drive_friction", "presliding")), "false", {"drive_friction"}),
        (ONE, diagnosis(), "none", set()),
        (ONE, diagnosis(verdict="unexplained", unexplained=True), "none", set()),
        (ONE, None, "no answer", set()),
        (PAIR, diagnosis("drive_friction", "backlash"), "both", set()),
        (PAIR, diagnosis("drive_friction", "backlash", "presliding"), "both", {"presliding"}),
        (PAIR, diagnosis("backlash"), "one", set()),
        (PAIR, diagnosis("backlash", named("presliding", "drive_friction")), "one", set()),
        (PAIR, diagnosis("presliding"), "none", {"presliding"}),
        (PAIR, None, "no answer", set()),
        (NOTHING, diagnosis(), "quiet", set()),
        (NOTHING, diagnosis("backlash"), "named", {"backlash"}),
        (NOTHING, None, "no answer", set()),
        (UNKNOWN, diagnosis("backlash"), "false", {"backlash"}),
        (UNKNOWN, diagnosis("backlash", unexplained=True), "recognised", {"backlash"}),
        (UNKNOWN, diagnosis(verdict="unexplained"), "recognised", set()),
        (UNKNOWN, diagnosis(), "missed", set()),
        (UNKNOWN, diagnosis("backlash", verdict="partly"), "recognised", {"backlash"}),
        (UNKNOWN, diagnosis(verdict="stand_in"), "recognised", set()),
        (UNKNOWN, None, "no answer", set()),
        (NEAR, diagnosis("backlash"), "false", {"backlash"}),
        (NEAR, diagnosis("drive_friction"), "right kind", set()),
        (NEAR, diagnosis(named("backlash", "drive_friction")), "right kind", set()),
        (NEAR, diagnosis("drive_friction", "backlash"), "false", {"backlash"}),
        (NEAR, diagnosis("drive_friction", unexplained=True), "recognised", set()),
        (NEAR, diagnosis(), "missed", set()),
        (NEAR, None, "no answer", set()),
        (MIXED, diagnosis("drive_friction"), "right kind", set()),
        (MIXED, diagnosis("backlash"), "false", {"backlash"}),
        (TRIPLE, diagnosis("backlash", "drive_friction", "presliding"), "all", set()),
        (TRIPLE, diagnosis("backlash", named("presliding", "drive_friction")), "all", set()),
        (TRIPLE, diagnosis("backlash", "free_tendon", "presliding"), "some", {"free_tendon"}),
        (TRIPLE, diagnosis("presliding"), "some", set()),
        (TRIPLE, diagnosis("free_tendon"), "none", {"free_tendon"}),
        (TRIPLE, None, "no answer", set()),
    ],
)
def test_the_class_of_a_case(truth, said, outcome, false):
    one = judged(truth, said)
    assert one.outcome == outcome
    assert one.false_names == false


STANDS_IN = {"stand_ins": [named("backlash")]}


@pytest.mark.parametrize(
    ("truth", "said", "right_name", "refused"),
    [
        (ONE, diagnosis("backlash"), True, False),
        (ONE, diagnosis("backlash", unexplained=True), True, True),
        (ONE, diagnosis("backlash", verdict="partly"), True, True),
        (ONE, diagnosis(verdict="stand_in", **STANDS_IN), True, True),
        (ONE, diagnosis("drive_friction", **STANDS_IN), False, False),
        (ONE, diagnosis("drive_friction", unexplained=True), False, False),
        (ONE, diagnosis(unexplained=True), False, False),
        (ONE, None, False, False),
        (NEAR, diagnosis("drive_friction", unexplained=True), False, False),
    ],
)
def test_a_right_name_is_refused_where_it_stands_in_or_comes_with_a_warning(
    truth, said, right_name, refused
):
    one = judged(truth, said)
    assert (one.right_name, one.refused) == (right_name, refused)


@pytest.mark.parametrize(
    ("said", "covered"),
    [
        ({"play_mm": estimate(0.10, "mm", 0.011)}, [True]),  # 0.02 off, 1.96 · 0.011 = 0.0216
        ({"play_mm": estimate(0.10, "mm", 0.010)}, [False]),  # 1.96 · 0.010 = 0.0196
        ({"play_mm": estimate(0.10, "mm", 0.001, interval_low=0.0, interval_high=0.12)}, [True]),
        ({"play_mm": estimate(0.10, "mm", 9.0, interval_low=0.0, interval_high=0.11)}, [False]),
        ({"play_mm": estimate(0.12, "mm")}, [None]),
        ({}, [None]),
    ],
)
def test_an_interval_holds_the_truth_or_not(said, covered):
    assert judged(ONE, diagnosis(named("backlash", **said))).covered == covered


def test_only_what_acts_in_truth_and_is_exactly_named_is_covered():
    truth = case("load_friction")
    truth["hidden"][0]["parameters"] = {"after_sensor_N": 0.5, "before_sensor_N": 0.0}
    inside = estimate(0.5, "N", 0.1)
    said = named("load_friction", after_sensor_N=inside, before_sensor_N=inside)
    assert judged(truth, diagnosis(said)).covered == [True]
    assert judged(truth, diagnosis(said, "backlash")).covered == []
    shaped = case("bend_drift")
    shaped["hidden"][0]["parameters"] = {"rate_rad_per_s": 0.01, "settling_per_s": 0.05}
    outside = estimate(0.5, "rad/s", 0.1)
    assert judged(shaped, diagnosis(named("bend_drift", rate_rad_per_s=outside))).covered == [False]


def test_a_gain_is_neutral_at_one():
    truth = case("force_sensor_gain")
    truth["hidden"][0]["parameters"] = {"f_out_gain": 1.0}
    assert judged(truth, diagnosis("force_sensor_gain")).covered == []


def test_both_effects_of_a_pair_are_covered():
    said = diagnosis(
        named("drive_friction", friction_N=estimate(1.0, "N", 0.1)),
        named("backlash", play_mm=estimate(0.12, "mm", 0.01)),
    )
    assert judged(PAIR, said).covered == [True, False]


@pytest.mark.parametrize(
    ("hidden", "laws", "right"),
    [
        ("pulley_friction", [described("drive_law")], True),
        ("pulley_friction", [described("load_law")], False),
        ("pulley_friction", [described("load_law", "drive_law+tendon_law")], True),
        ("pulley_friction", [], None),
        ("thermal_offset", [described("drive_law")], None),
    ],
)
def test_the_place_of_a_law_is_right_where_the_cause_acts_there(hidden, laws, right):
    truth = case(kind="near", unknown=hidden)
    assert judged(truth, diagnosis(verdict="described", laws=laws)).right_place is right


def channel(before, after, best):
    return {"rmse_before": before, "rmse_after": after, "noise_floor": 0.1, "attainable": best}


@pytest.mark.parametrize(
    ("channels", "gain"),
    [
        ({"f_in_N": channel(1.0, 0.4, 0.2)}, 0.75),
        ({"f_in_N": channel(0.4, 1.0, 0.2)}, -3.0),
        ({"f_in_N": channel(1.0, 0.2, 0.2), "x_out_mm": channel(3.0, 2.0, 1.0)}, 0.75),
        ({"f_in_N": channel(1.0, 0.2, 0.2), "x_out_mm": channel(1.1, 0.0, 1.0)}, 1.0),
        ({"f_in_N": channel(1.0, None, 0.2)}, None),
        ({}, None),
    ],
)
def test_the_gain_is_a_share_of_the_best_obtainable(channels, gain):
    assert judged(ONE, diagnosis("backlash", channels=channels)).gain == (
        None if gain is None else pytest.approx(gain)
    )
