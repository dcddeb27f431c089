"""A small fixed part of the blind benchmark (`make challenge`): what is hidden has to be found."""

import json

import pytest

from tests.studies.challenge.recorded import recordings
from tsas_cli.stages.diagnose import diagnose
from tsas_studies.challenge.cases import cases, part
from tsas_studies.challenge.right_kind import RIGHT_KIND

SEED = 3  # for building, never for scoring
CASES = cases(SEED)
PART = part(CASES)
# tests/metamorphic/test_relations.py finds free tendon, and nothing where nothing is hidden;
# tests/diagnosis/test_faults.py finds friction in the sheath that depends on the motion.
EACH_TIME = {  # with the rate that is enough [Hz]
    "backlash, size 1": 30.0,
    "viscous_friction, size 1": 50.0,
    "load_friction, size 1": 30.0,
    "force_sensor_gain, size 1": 30.0,
    "sheath_compression, size 1": 30.0,  # what a softer tendon does too
    "hum": 50.0,
    "strand_roll, size 1": 30.0,
    "nothing 1 in slow noise": 30.0,
}


def diagnosed(case, folder, **how):
    runs, rate_Hz = "ab" if case.name in EACH_TIME else "abcd", EACH_TIME.get(case.name, 100.0)
    dataset = recordings(folder, case, rate_Hz=rate_Hz, runs=runs)
    diagnose(dataset, out=folder / "answer", **how)
    return json.loads((folder / "answer" / "diagnosis.json").read_text())


def of_kind(kind, among=PART, conditions=None):
    return [
        pytest.param(case, id=case.name, marks=() if case.name in EACH_TIME else pytest.mark.large)
        for case in among
        if case.kind == kind and conditions in (None, case.conditions)
    ]


@pytest.mark.parametrize("case", of_kind("one"))
def test_a_hidden_effect_is_named_and_no_other(case, tmp_path):
    said = diagnosed(case, tmp_path, despite="hum")
    (hidden,) = case.hidden
    assert [cause["effect"] for cause in said["named"]] == [hidden.cause]
    assert said["verdict"] in ("named", "ambiguous")
    (cause,) = said["named"]
    assert cause["gain_percent"] > 2.0
    low, high = cause["gain_interval_percent"]
    assert low < cause["gain_percent"] < high


@pytest.mark.parametrize("case", of_kind("nothing"))
def test_where_nothing_is_hidden_nothing_is_named(case, tmp_path):
    said = diagnosed(case, tmp_path, despite="hum")
    assert said["verdict"] == "sufficient"
    assert said["named"] == []
    assert not said["remainder"]["unexplained"]


@pytest.mark.parametrize("case", of_kind("unknown"))
def test_what_the_catalogue_does_not_hold_is_said_to_be_unexplained(case, tmp_path):
    said = diagnosed(case, tmp_path, despite="hum")
    assert said["remainder"]["unexplained"]
    assert said["remainder"]["depends_on"]


@pytest.mark.parametrize("case", of_kind("near", CASES, "clean"))
def test_a_wrong_name_is_never_given_without_a_warning(case, tmp_path):
    said = diagnosed(case, tmp_path)
    named = {cause["effect"] for cause in said["named"]}
    warned = said["verdict"] in ("partly", "described", "stand_in", "unexplained")
    assert warned == said["remainder"]["unexplained"]
    cause = case.hidden[0].cause if case.hidden else case.name.split(",")[0]
    assert warned or named <= {cause, *RIGHT_KIND.get(cause, ())}
    described = bool(said["laws"])
    assert (said["verdict"] == "described") == (described and not named)
    if not described:
        assert (said["verdict"] == "stand_in") == (bool(said["stand_ins"]) and not named)


@pytest.mark.parametrize("case", of_kind("nothing", CASES, "slow"))
def test_slow_noise_is_said_with_its_size_and_names_nothing(case, tmp_path):
    said = diagnosed(case, tmp_path)
    assert (said["verdict"], said["named"], said["stand_ins"]) == ("sufficient", [], [])
    slow = said["remainder"]["slow_noise"]
    assert slow["f_out_N"]["sd"] == pytest.approx(0.1, rel=0.35)
    assert 0.3 < slow["f_out_N"]["time_s"] < 3.0
