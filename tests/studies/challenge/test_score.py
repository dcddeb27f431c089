"""A small set, scored by hand."""

import pytest

from tests.studies.challenge.made import (
    case,
    described,
    diagnosis,
    estimate,
    named,
    write_entry,
    write_set,
)
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.score import score_entries
from tsas_studies.challenge.tables import tables

CASES = {
    "c1": case(),
    "a1": case("backlash"),
    "a2": case("backlash"),
    "a3": case("drive_friction"),
    "a4": case("drive_friction", size=0.4),
    "b1": case("backlash", "drive_friction"),
    "c2": case(),
    "d1": case(unknown="rough_spot"),
    "d2": case(unknown="hum"),
    "d3": case(unknown="hum"),
    "e1": case("backlash", "drive_friction", "presliding"),
    "e2": case("backlash", "drive_friction", "presliding"),
    "f1": case(kind="near", unknown="pulley_friction"),
    "g1": case(conditions="slow"),
    "h1": case(kind="fault", unknown="encoder_play"),
    "h2": case(kind="fault", unknown="sensor_lag"),
    "h3": case(kind="fault", unknown="encoder_play"),
    "r1": case("backlash", conditions="realistic"),
    "r2": case(conditions="realistic"),
    "r3": case(kind="near", unknown="pulley_friction", conditions="realistic"),
}
GOOD = estimate(0.12, "mm", 0.01)


def channels(after):
    """Return a gain of 0.75 for 0.4, 1 for 0.2, 0 for 1.0."""
    return {"f_in_N": {"rmse_before": 1.0, "rmse_after": after, "attainable": 0.2}}


SAID = {
    "a1": diagnosis(
        named("backlash", "free_tendon", play_mm=GOOD), channels=channels(0.4), seconds=3.0
    ),
    "a2": diagnosis("presliding", seconds=5.0),
    "a3": diagnosis(named("backlash", "drive_friction"), channels=channels(0.2), seconds=10.0),
    "b1": diagnosis(
        named("backlash", play_mm=GOOD),
        named("drive_friction", friction_N=estimate(1.5, "N")),
        channels=channels(1.0),
    ),
    "c1": diagnosis(verdict="unexplained"),
    "c2": diagnosis("backlash"),
    "d1": diagnosis(verdict="unexplained", unexplained=True, channels=channels(0.9)),
    "d2": diagnosis("drive_ripple"),
    "e1": diagnosis("backlash", named("drive_friction", "presliding")),
    "e2": diagnosis("backlash", "free_tendon"),
    "f1": diagnosis("drive_friction", laws=[described("drive_law")]),
    "g1": diagnosis(verdict="unexplained"),
    "h1": diagnosis("force_sensor_offset", verdict="partly"),
    "h2": diagnosis("sensor_lag"),
    "h3": diagnosis("drive_ripple"),
    "r1": diagnosis(named("backlash", play_mm=GOOD), verdict="partly"),
    "r2": diagnosis(),
    "r3": diagnosis("backlash", verdict="stand_in"),
}


@pytest.fixture
def sealed(tmp_path):
    return write_set(tmp_path / "set", CASES)


@pytest.fixture
def entry(tmp_path):
    return write_entry(tmp_path / "entry", SAID)


def scored(sealed, entry):
    return score_entries(sealed, [entry])["entries"][str(entry)]


def test_every_figure_is_the_one_counted_by_hand(sealed, entry):
    figures = {f["name"]: (f["hits"], f["cases"]) for f in scored(sealed, entry)["figures"]}
    assert figures == {
        "answered": (18, 20),
        "one_exact": (1, 4),
        "size_1_exact": (1, 3),
        "size_1_alone": (0, 3),
        "size_1_rivals": (1, 3),
        "size_1_false": (1, 3),
        "size_0.4_exact": (0, 1),
        "size_0.4_alone": (0, 1),
        "size_0.4_rivals": (0, 1),
        "size_0.4_false": (0, 0),
        "pair_both": (1, 1),
        "pair_one": (0, 1),
        "pair_false": (0, 1),
        "triple_all": (1, 2),
        "triple_false": (1, 2),
        "nothing_named": (1, 2),
        "nothing_unexplained": (1, 2),
        "slow_nothing_named": (0, 1),
        "slow_nothing_unexplained": (1, 1),
        "beyond_wrong": (1, 3),
        "beyond_unwarned": (1, 3),
        "beyond_recognised": (2, 4),
        "beyond_gain": (0, 1),
        "beyond_place": (1, 1),
        "unknown_recognised": (1, 3),
        "near_recognised": (1, 1),
        "recording_right": (0, 0),
        "recording_wrong": (0, 0),
        "one_accused": (0, 4),
        "sound_accused": (0, 4),
        "fault_wrong": (2, 3),
        "fault_unwarned": (1, 3),
        "right_refused": (0, 1),
        "coverage": (2, 2),
        "without_interval": (1, 3),
        "realistic_one_exact": (1, 1),
        "realistic_pair_both": (0, 0),
        "realistic_pair_one": (0, 0),
        "realistic_pair_false": (0, 0),
        "realistic_triple_all": (0, 0),
        "realistic_triple_false": (0, 0),
        "realistic_nothing_named": (0, 1),
        "realistic_nothing_unexplained": (0, 1),
        "realistic_beyond_wrong": (1, 1),
        "realistic_beyond_unwarned": (0, 1),
        "realistic_beyond_recognised": (1, 1),
        "realistic_beyond_gain": (0, 0),
        "realistic_beyond_place": (0, 0),
        "realistic_unknown_recognised": (0, 0),
        "realistic_near_recognised": (1, 1),
        "realistic_right_refused": (1, 1),
        "realistic_coverage": (1, 1),
        "realistic_without_interval": (0, 1),
    }


def test_the_targets_are_held_against_the_worst_effect(sealed, entry):
    figures = {f["name"]: f for f in scored(sealed, entry)["figures"]}
    assert figures["size_1_exact"]["worst"] == {"effect": "drive_friction", "hits": 0, "cases": 1}
    assert figures["size_1_false"]["worst"] == {"effect": "backlash", "hits": 1, "cases": 2}
    assert {name: f["met"] for name, f in figures.items() if f["target"]} == {
        "answered": False,
        "one_exact": False,
        "size_1_exact": False,
        "size_1_false": False,
        "size_0.4_exact": False,
        "pair_both": True,
        "triple_all": False,
        "nothing_named": False,
        "nothing_unexplained": False,
        "slow_nothing_named": True,
        "slow_nothing_unexplained": False,
        "beyond_wrong": False,
        "beyond_unwarned": False,
        "beyond_recognised": False,
        "beyond_gain": False,
        "beyond_place": True,
        "fault_wrong": False,
        "recording_right": None,
        "recording_wrong": None,
        "sound_accused": True,
        "fault_unwarned": False,
        "right_refused": True,
        "coverage": False,  # 100 % is above 98 %: such intervals are too wide
        "realistic_one_exact": True,
        "realistic_beyond_wrong": False,
        "realistic_beyond_unwarned": True,
        "realistic_beyond_recognised": True,
        "realistic_right_refused": False,
        "realistic_coverage": True,
    }


def test_one_bad_effect_is_not_hidden_by_many_good_ones(tmp_path):
    cases = {f"g{i}": case("backlash") for i in range(99)} | {"bad": case("drive_friction")}
    said = {f"g{i}": diagnosis("backlash") for i in range(99)} | {"bad": diagnosis()}
    content = scored(write_set(tmp_path / "s", cases), write_entry(tmp_path / "e", said))
    exact = next(f for f in content["figures"] if f["name"] == "size_1_exact")
    assert (exact["share"], exact["met"]) == (0.99, False)


def test_the_rest_of_the_summary(sealed, entry):
    content = scored(sealed, entry)
    assert content["gain"] == {"median": pytest.approx(0.75), "cases": 3}
    assert content["seconds"] == {"median": 5.0, "max": 10.0, "cases": 3}
    # a1, a3 and e1 list one each; a2, b1, c2, d2, e2, f1, h1 to h3, r1, r3 list none
    assert content["rivals_per_name"] == {"mean": pytest.approx(3 / 17), "names": 17}
    assert content["no_answer"] == dict.fromkeys(("a4", "d3"), "no diagnosis.json")


def test_the_confusions_say_who_was_taken_for_whom(sealed, entry):
    found = {(c["hidden"], c["said"]): c["cases"] for c in scored(sealed, entry)["confusion"]}
    assert found == {
        ("backlash", "presliding"): 1,
        ("drive_friction", "backlash"): 1,
        ("drive_friction", "no answer"): 1,
        ("nothing", "unexplained"): 2,
        ("backlash + drive_friction + presliding", "backlash + drive_friction"): 1,
        ("backlash + drive_friction + presliding", "backlash + free_tendon"): 1,
        ("nothing", "backlash"): 1,
        ("hum (not in the catalogue)", "drive_ripple"): 1,
        ("encoder_play (not in the catalogue)", "drive_ripple"): 1,
        ("hum (not in the catalogue)", "no answer"): 1,
    }


def test_hidden_and_named_exchanged_is_another_score(tmp_path):
    """Two hidden and one named is one of the pair; one hidden and two named is a false name."""
    two, one = ("backlash", "drive_friction"), ("backlash",)
    outcomes = []
    for number, (hidden, said) in enumerate([(two, one), (one, two)]):
        sealed = write_set(tmp_path / f"s{number}", {"a": case(*hidden)})
        entry = write_entry(tmp_path / f"e{number}", {"a": diagnosis(*said)})
        outcomes.append(scored(sealed, entry)["cases"]["a"])
    assert outcomes == [
        {"outcome": "one", "named_falsely": []},
        {"outcome": "false", "named_falsely": ["drive_friction"]},
    ]


def test_entries_stand_side_by_side(sealed, entry, tmp_path):
    other = write_entry(tmp_path / "baseline", {"a1": diagnosis()})
    content = score_entries(sealed, [entry, other])
    assert content["answers"]["cases"] == {
        "one": 4,
        "pair": 1,
        "triple": 2,
        "nothing": 2,
        "unknown": 3,
        "near": 1,
        "fault": 3,
        "slow nothing": 1,
        "realistic one": 1,
        "realistic nothing": 1,
        "realistic near": 1,
    }
    title, header, rows = next(tables(content))
    assert (
        "seed 17: 4 one, 1 pair, 2 triple, 2 nothing, 3 unknown, 1 near, 3 fault, 1 slow" in title
    )
    assert header == ("figure", "target", str(entry), "met", str(other), "met")
    by_title = {row[0]: row for row in rows}
    assert by_title["two effects: both named"] == (
        *("two effects: both named", "≥ 93 %"),
        *("100.0 % [20.7, 100.0] of 1", "yes", "0.0 % [0.0, 79.3] of 1", "no"),
    )
    assert by_title["size 1: named exactly"][1::2] == ("", "", "")
    assert by_title["size 1: named exactly"][2] == "33.3 % [6.1, 79.2] of 3"
    assert ("  the worst effect", "≤ 2 % for each effect", "1 of 2, backlash", "no") in (
        row[:4] for row in rows
    )
    assert by_title["nothing hidden: something named"][4:] == ("no cases", "")
    assert by_title["seconds per case"][2:] == ("median 5, max 10", "", "not said", "")


def test_the_table_by_effect_has_the_sizes_side_by_side(sealed, entry):
    found = {
        title: (header, rows) for title, header, rows in tables(score_entries(sealed, [entry]))
    }
    header, rows = found[f"{entry}: single effects, number of cases by size"]
    classes = ("rivals", "false", "none", "cases")
    assert header == ("effect", "1: exact", *classes, "0.4: exact", *classes)
    assert rows == [
        ("backlash", "1", "0", "1", "0", "2", "", "", "", "", ""),
        ("drive_friction", "0", "1", "0", "0", "1", "0", "0", "0", "0", "1"),
    ]
    assert ("a4", "no diagnosis.json") in found[f"{entry}: no answer"][1]
    (missing,) = (title for title in found if title.startswith("not in this set"))
    assert "free_tendon" in missing
    assert "backlash" not in missing


def test_an_entry_is_given_once(sealed, entry):
    with pytest.raises(InputError, match="given twice"):
        score_entries(sealed, [entry, entry])
