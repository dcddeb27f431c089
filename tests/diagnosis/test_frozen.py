"""What a diagnosis says is never changed afterwards, and a stage's result is one of its own."""

from dataclasses import FrozenInstanceError, fields

import pytest

from tsas_cli.diagnosis.candidates import Candidate
from tsas_cli.diagnosis.channel_errors import Channel
from tsas_cli.diagnosis.diagnose import Cause, Diagnosis
from tsas_cli.diagnosis.evidence import Gain
from tsas_cli.diagnosis.further_runs import FurtherRuns
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.plan import Better, Plan, Proposal
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.diagnosis.rig_file import Limits
from tsas_cli.diagnosis.search import Hypotheses
from tsas_cli.diagnosis.visibility import Cause as Seeable
from tsas_cli.diagnosis.visibility import Imitation, Look, Part, Seen
from tsas_cli.drive.diagnosis import DriveCause, DriveDiagnosis
from tsas_cli.stages.diagnose import DiagnosisResult
from tsas_cli.stages.identify_harmonic_drive import DriveResult
from tsas_cli.stages.plan import PlanResult

RESULTS = (DiagnosisResult, DriveResult, PlanResult)
FOUND = (
    *(Candidate, Channel, Cause, Diagnosis, DriveCause, DriveDiagnosis, Gain, FurtherRuns, Folds),
    *(Better, Plan, Proposal, Remainder, Seeable, Imitation, Hypotheses, Look, Part, Seen),
)


@pytest.mark.parametrize("kind", FOUND + RESULTS)
def test_what_was_found_stays_as_it_is(kind):
    found = object.__new__(kind)
    with pytest.raises(FrozenInstanceError):
        setattr(found, fields(kind)[0].name, None)


@pytest.mark.parametrize("kind", RESULTS)
def test_a_result_is_known_by_itself_and_prints_its_tables(kind):
    first, second = object.__new__(kind), object.__new__(kind)
    for result in (first, second):
        for field in fields(kind):
            object.__setattr__(result, field.name, {})  # equal in every field
    assert first != second
    assert len({first, second}) == 2
    assert not kind.__repr__.__qualname__.startswith(kind.__name__)


def test_limits_are_frozen_finite_and_known():
    with pytest.raises(ValueError, match="frozen"):
        Limits().amplitude_mm = 1.0
    with pytest.raises(ValueError, match="finite"):
        Limits(preload_N=(float("inf"),))
    with pytest.raises(ValueError, match="Extra inputs"):
        Limits(preload=(1.0,))
