"""Beside the catalogue a diagnosis names nothing that is not there, or says that it is not sure."""

import json

import pytest

from tests.studies.challenge.recorded import recordings
from tsas_cli.stages.diagnose import diagnose
from tsas_studies.challenge.cases import cases
from tsas_studies.challenge.right_kind import RIGHT_KIND

SEED = 3  # for building, never for scoring
CASES = cases(SEED)
EACH_TIME = ("strand_roll, size 1", "nothing 1 in slow noise")


def diagnosed(case, folder):
    small = case.name in EACH_TIME
    how = {"rate_Hz": 30.0, "runs": "ab"} if small else {"rate_Hz": 100.0}
    diagnose(recordings(folder, case, **how), out=folder / "answer")
    return json.loads((folder / "answer" / "diagnosis.json").read_text())


def tried(kind, conditions):
    return [
        pytest.param(case, id=case.name, marks=() if case.name in EACH_TIME else pytest.mark.large)
        for case in CASES
        if (case.kind, case.conditions) == (kind, conditions)
    ]


@pytest.mark.parametrize("case", tried("near", "clean"))
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


@pytest.mark.parametrize("case", tried("nothing", "slow"))
def test_slow_noise_is_said_with_its_size_and_names_nothing(case, tmp_path):
    said = diagnosed(case, tmp_path)
    assert (said["verdict"], said["named"], said["stand_ins"]) == ("sufficient", [], [])
    slow = said["remainder"]["slow_noise"]
    assert slow["f_out_N"]["sd"] == pytest.approx(0.1, rel=0.35)
    assert 0.3 < slow["f_out_N"]["time_s"] < 3.0
