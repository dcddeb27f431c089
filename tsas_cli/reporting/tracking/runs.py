"""The runs that the plots show: for each condition, each controller's with the first seed."""

from collections.abc import Mapping
from dataclasses import dataclass

from tsas_cli.recordings.writing import columns_of, result_file
from tsas_cli.records.tracking import ADAPTIVE, ConditionChange, TrackedResult, TrackingFile
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.support.arrays import Floats

WANTED, TRUE, ASKED = "f_out_ref_N", "f_out_true_N", "motor_speed_rpm"
X_IN, X_INV = "x_in_mm", "x_inv_mm"
ESTIMATES = ("phi1_rpm_s3_per_mm", "phi2_rpm_s_per_mm", "phi3_rpm_s2_per_mm")
_COLUMNS = ("time_s", WANTED, TRUE, ASKED, X_IN, X_INV)


@dataclass(frozen=True)
class TrackedRun:
    """One run: its scores, and its columns by name, shape (n,) each."""

    result: TrackedResult
    columns: Mapping[str, Floats]

    @property
    def name(self) -> str:
        """The controller."""
        return self.result.controller

    @property
    def time_s(self) -> Floats:
        """Time [s]."""
        return self.columns["time_s"]

    @property
    def error(self) -> Floats:
        """Wanted less true force at the load [N]."""
        return self.columns[WANTED] - self.columns[TRUE]


@dataclass(frozen=True)
class RunsUnderCondition:
    """What is done to the plant, and the runs under it, at least one."""

    name: str
    number: int
    changes: tuple[ConditionChange, ...]
    runs: tuple[TrackedRun, ...]

    @property
    def change_s(self) -> float | None:
        """When within the run the plant changes, or None where it does not."""
        return max((c.from_s for c in self.changes if c.from_s > 0.0), default=None)


def read_conditions(inputs: Inputs, tracking: TrackingFile) -> tuple[RunsUnderCondition, ...]:
    """Read what the plots need, in the order of the file.

    InputError: a run cannot be read, or lacks a column.
    """
    folder = inputs.folders[TrackingFile]
    found: dict[str, list[TrackedRun]] = {}
    for result in tracking.results:
        more = ESTIMATES if result.controller == ADAPTIVE else ()
        followed = TrackedRun(
            result, columns_of(result_file(folder, result.run), (*_COLUMNS, *more))
        )
        found.setdefault(result.condition, []).append(followed)
    return tuple(
        RunsUnderCondition(name, number, tracking.conditions.get(name, ()), tuple(runs))
        for number, (name, runs) in enumerate(found.items())
    )
