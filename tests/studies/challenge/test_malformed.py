"""What is wrong with answers or an entry is one line with the file and the key."""

import json

import pytest

from tests.studies.challenge.made import case, diagnosis, estimate, named, write_entry, write_set
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.entry import read_entry
from tsas_studies.challenge.truth import read_truth


def line(read, *arguments):
    with pytest.raises(InputError) as raised:
        read(*arguments)
    return raised.value.line()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"kind": "many"}, "cases.a.kind: "),
        ({"kind": "pair"}, "cases.a: kind pair goes with 2 hidden effects, got 1"),
        ({"kind": "nothing"}, "cases.a: kind nothing goes with 0 hidden effects, got 1"),
        ({"unknown": "hum"}, "cases.a: unknown is given for the kinds unknown and near"),
        ({"size": None}, "cases.a: size is missing"),
        (
            {"hidden": [{"effect": "backlsh", "parameters": {}}]},
            "cases.a.hidden.0: unknown effect backlsh (did you mean backlash?)",
        ),
        (
            {"hidden": [{"effect": "backlash", "parameters": {"play": 0.1}}]},
            "backlash has no parameter play (did you mean play_mm?)",
        ),
        (
            {"hidden": [{"effect": "backlash", "parameters": {"play_mm": "wide"}}]},
            "cases.a.hidden.0.parameters.play_mm: ",
        ),
        ({"hidden": [{"effect": "backlash"}]}, "cases.a.hidden.0.parameters is missing"),
    ],
)
def test_wrong_answers(tmp_path, change, told):
    folder = write_set(tmp_path / "set", {"a": case("backlash") | change})
    said = line(read_truth, folder)
    assert said.startswith(f"{folder / 'answers.json'}: ")
    assert told in said


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("{", "is not JSON"),
        ("[]", "a table"),
        ("{}", "format is missing; kind is missing"),
        (json.dumps({"format": 2, "kind": "x", "seed": 1, "cases": {}}), "format: "),
    ],
)
def test_answers_that_are_something_else(tmp_path, content, told):
    (tmp_path / "answers.json").write_text(content, encoding="utf-8")
    assert told in line(read_truth, tmp_path)


def test_a_case_cannot_lead_out_of_the_folder(tmp_path):
    content = {"format": 1, "kind": "challenge-answers", "seed": 1, "cases": {"../b": case()}}
    (tmp_path / "answers.json").write_text(json.dumps(content), encoding="utf-8")
    assert "cases.../b" in line(read_truth, tmp_path)


def test_a_folder_without_answers(tmp_path):
    assert "no answers.json here" in line(read_truth, tmp_path)


PLAY = estimate(0.1, "mm", 0.01)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"format": 2}, "format: "),
        ({"verdict": "sure"}, "verdict: "),
        ({"remainder": {}}, "remainder.unexplained is missing"),
        ({"seconds": -1.0}, "seconds: "),
        ({"seconds": float("nan")}, "seconds: "),
        ({"channels": {"f_in_N": {"rmse_before": -1.0}}}, "channels.f_in_N.rmse_before: "),
        ({"named": [{"rivals": []}]}, "named.0.effect is missing"),
        (
            {"named": [named("backlash", play_mm=PLAY | {"unit": "m"})]},
            "named.0: play_mm is in m, expected mm",
        ),
        (
            {"named": [named("backlash", play_mm=PLAY | {"stderr": -0.1})]},
            "named.0.parameters.play_mm.stderr: ",
        ),
        (
            {"named": [named("backlash", play_mm=PLAY | {"interval_low": 0.0})]},
            "named.0.parameters.play_mm: interval_low and interval_high go together",
        ),
        (
            {"named": [named("backlash", play_mm=PLAY | {"interval_low": 1, "interval_high": 0})]},
            "interval_low 1 is above interval_high 0",
        ),
        ({"named": ["backlash"]}, "named.0: "),
        ({"named": [named("backlash"), named("backlash")]}, "backlash is named twice"),
    ],
)
def test_a_wrong_diagnosis(tmp_path, change, told):
    folder = write_entry(tmp_path / "entry", {"a": diagnosis() | change})
    said = line(read_entry, folder, ["a"])
    assert said.startswith(f"{folder / 'a' / 'diagnosis.json'}: ")
    assert told in said


def test_a_diagnosis_may_hold_more_and_name_what_we_do_not_know(tmp_path):
    more = named("my_effect", my_mm=estimate(1.0, "mm")) | {"probability": 0.9}
    folder = write_entry(tmp_path / "entry", {"a": diagnosis(more) | {"tool": "mine"}})
    assert read_entry(folder, ["a"]).diagnoses["a"].effects == {"my_effect"}


def test_an_answer_to_another_set(tmp_path):
    folder = write_entry(tmp_path / "entry", {"z": diagnosis()})
    assert "z is not a case of this set" in line(read_entry, folder, ["a"])


def test_an_entry_that_is_not_there(tmp_path):
    assert "no such folder" in line(read_entry, tmp_path / "none", ["a"])
