"""A sealed set cannot be looked up by its seed, and says what was changed since."""

import json
import shutil

import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge import cases as listed
from tsas_studies.challenge.make import make
from tsas_studies.challenge.score import score_entries
from tsas_studies.challenge.stages import make_set

NAMES = ("backlash, size 1", "nothing 1")


def two(seed, salt=0):
    return tuple(case for case in listed.cases(seed, salt) if case.name in NAMES)


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    out = tmp_path_factory.mktemp("set")
    make(out, two(5, 2**127 + 1), rate_Hz=25.0)
    return out


def answers(folder):
    return json.loads((folder / "answers.json").read_text(encoding="utf-8"))


def signals(folder):
    """Return f_in of every run of every case as bytes."""
    datasets = (read_dataset(case / "dataset") for case in (folder / "cases").iterdir())
    return {run.columns["f_in_N"].tobytes() for dataset in datasets for run in dataset}


def test_the_same_seed_with_another_salt_shares_nothing(sealed, tmp_path):
    make(tmp_path, two(5, 2**127 + 2), rate_Hz=25.0)
    assert answers(sealed)["seed"] == answers(tmp_path)["seed"] == 5
    assert not answers(sealed)["cases"].keys() & answers(tmp_path)["cases"].keys()
    assert len(signals(sealed)) == 8
    assert not signals(sealed) & signals(tmp_path)
    values = [two(5, salt)[0].hidden[0].parameters["play_mm"] for salt in range(3)]
    assert len(set(values)) == 3


def test_without_a_salt_given_it_is_fresh_and_with_it_the_set_is_made_again(tmp_path, monkeypatch):
    only = listed.cases
    monkeypatch.setattr(
        listed, "cases", lambda *seed: tuple(c for c in only(*seed) if c.name == NAMES[1])
    )
    for name in ("one", "two"):
        make_set(out=tmp_path / name, seed=5, rate_Hz=25.0)
    salts = [answers(tmp_path / name)["salt"] for name in ("one", "two")]
    assert len(set(salts)) == 2
    assert all(len(salt) == 32 for salt in salts)
    make_set(out=tmp_path / "again", seed=5, rate_Hz=25.0, salt=salts[0])
    assert answers(tmp_path / "again") == answers(tmp_path / "one")
    for wrong in ("", "0x1", "g", 33 * "0", 5):
        with pytest.raises(InputError):
            make_set(out=tmp_path / "none", seed=5, salt=wrong)


def changed(content):
    name, case = next((n, c) for n, c in content["cases"].items() if c["hidden"])
    case["hidden"][0]["parameters"]["play_mm"] *= 1.1
    return name


def exchanged(content):
    one, other = content["cases"]
    both = content["cases"]
    both[one], both[other] = both[other], both[one]
    return one


@pytest.mark.parametrize("edit", [changed, exchanged])
def test_an_answer_that_is_not_the_sealed_one_is_named(sealed, tmp_path, edit):
    folder = tmp_path / "set"
    shutil.copytree(sealed, folder)
    score_entries(folder, [])
    content = answers(folder)
    name = edit(content)
    (folder / "answers.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=f"cases.{name} is not the answer that was sealed"):
        score_entries(folder, [])


def test_recordings_of_two_cases_that_were_exchanged_are_named(sealed, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(sealed, folder)
    one, other = sorted((folder / "cases").iterdir())
    for source, target in ((one, "kept"), (other, one.name), (folder / "cases/kept", other.name)):
        source.rename(folder / "cases" / target)
    with pytest.raises(InputError, match="is not the recording that was sealed for this case"):
        score_entries(folder, [])
