"""A small fixed part of the blind benchmark (`make challenge`): what is hidden has to be found."""

import json

import pytest

from tests.studies.challenge.recorded import recordings
from tsas_cli.stages.diagnose import diagnose
from tsas_studies.challenge.cases import cases, part

SEED = 3  # for building, never for scoring
CASES = part(cases(SEED))
# tests/metamorphic/test_relations.py finds free tendon, and nothing where nothing is hidden;
# tests/diagnosis/test_faults.py finds friction in the sheath that depends on the motion.
EACH_TIME = {  # with the rate that is enough [Hz]
    "backlash, size 1": 30.0,
    "viscous_friction, size 1": 50.0,
    "load_friction, size 1": 30.0,
    "force_sensor_gain, size 1": 30.0,
    "sheath_compression, size 1": 30.0,  # what a softer tendon does too
    "hum": 50.0,
}


def diagnosed(case, folder):
    runs, rate_Hz = "ab" if case.name in EACH_TIME else "abcd", EACH_TIME.get(case.name, 100.0)
    dataset = recordings(folder, case, rate_Hz=rate_Hz, runs=runs)
    diagnose(dataset, despite="hum", out=folder / "answer")  # which checks find, too
    return json.loads((folder / "answer" / "diagnosis.json").read_text())


def of_kind(kind):
    return [
        pytest.param(case, id=case.name, marks=() if case.name in EACH_TIME else pytest.mark.large)
        for case in CASES
        if case.kind == kind
    ]


@pytest.mark.parametrize("case", of_kind("one"))
def test_a_hidden_effect_is_named_and_no_other(case, tmp_path):
    said = diagnosed(case, tmp_path)
    (hidden,) = case.hidden
    assert [cause["effect"] for cause in said["named"]] == [hidden.cause]
    assert said["verdict"] in ("named", "ambiguous")
    (cause,) = said["named"]
    assert cause["gain_percent"] > 2.0
    low, high = cause["gain_interval_percent"]
    assert low < cause["gain_percent"] < high


@pytest.mark.parametrize("case", of_kind("nothing"))
def test_where_nothing_is_hidden_nothing_is_named(case, tmp_path):
    said = diagnosed(case, tmp_path)
    assert said["verdict"] == "sufficient"
    assert said["named"] == []
    assert not said["remainder"]["unexplained"]


@pytest.mark.parametrize("case", of_kind("unknown"))
def test_what_the_catalogue_does_not_hold_is_said_to_be_unexplained(case, tmp_path):
    said = diagnosed(case, tmp_path)
    assert said["remainder"]["unexplained"]
    assert said["remainder"]["depends_on"]
