"""What the parts of an identification hand on to each other is not changed behind their backs."""

from dataclasses import FrozenInstanceError, fields

import pytest

from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.file import IdentifiedDrive
from tsas_cli.drive.fit import DriveTrial
from tsas_cli.drive.frequency_response import FrequencyResponse
from tsas_cli.drive.runs import DriveRun
from tsas_cli.identification.calibration import Calibration
from tsas_cli.identification.comparison import Compared, RunSummary
from tsas_cli.identification.dynamic_fit import DynamicFit, Look, Solved
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, Trial
from tsas_cli.identification.fit import Fitted, Solution, Unknown
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.joint_fit import FittedModel
from tsas_cli.identification.long_runs import LongRun, Rows
from tsas_cli.identification.missing_effects import Widened
from tsas_cli.identification.model import Model
from tsas_cli.identification.phases import Segment, _Stroke
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import Quantity
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.identification.run_simulation import RunSimulation
from tsas_cli.identification.screening import Screened
from tsas_cli.identification.stiffness import Slope
from tsas_cli.identification.stored_value import StoredValue
from tsas_cli.identification.transfer import _Line
from tsas_cli.stages.calibrate import CalibrationResult
from tsas_cli.stages.simulate import SimulationResult

FROZEN = (
    *(Calibration, CalibrationResult, Compared, DataSheet, DriveRun, DriveTrial, DynamicFit),
    *(
        Estimate,
        Fitted,
        FrequencyResponse,
        IdentifiedDrive,
        LongRun,
        Look,
        Model,
        Prepared,
        Quantity,
        Rows,
    ),
    *(Screened, Segment, SimulationResult, Slope, Solution, Solved, RunSummary, Trial, Unknown),
    *(Bench, FitProblem, FittedModel, RunErrors, RunSimulation),
    *(Widened, _Line, _Stroke),
)


@pytest.mark.parametrize("made", FROZEN, ids=lambda made: made.__name__)
def test_what_is_handed_on_stays_as_it_is(made):
    whole = object.__new__(made)
    with pytest.raises(FrozenInstanceError):
        setattr(whole, fields(made)[0].name, None)


def test_a_stored_value_stays_as_it_is():
    value = StoredValue(value=1.0, unit="N")
    with pytest.raises(ValueError, match="frozen"):
        value.value = 2.0
    assert value.at_bound is False
