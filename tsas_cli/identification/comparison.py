"""A model's prediction of one run, and its residual."""

from collections.abc import Mapping, Set
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.dynamic_notes import dynamic_notes
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import Dynamics, Prediction, simulate
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Run
from tsas_cli.records.simulation import SimulatedChannel, SimulatedRun
from tsas_cli.support.errors import InputError

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Compared:
    """One run simulated; `channels` are the predictions, shape (n,), NaN in gaps of the drive."""

    response: Prediction
    channels: dict[str, Floats]
    rmse: dict[str, float]
    samples: dict[str, int]
    notes: tuple[str, ...] = ()

    def summary(self) -> "RunSummary":
        """Return the figures of the prediction that are written."""
        phase = self.response.phase
        return RunSummary(
            self.response.solver,
            int(phase.size),
            int(np.count_nonzero(phase == SLACK)),
            int(np.count_nonzero(phase == UNCONVERGED)),
            self.rmse,
            self.samples,
            self.notes,
        )


@dataclass(frozen=True)
class RunSummary:
    """Figures of one simulated run: the solver, the samples, the RMS of each residual."""

    solver: str
    rows: int
    slack: int
    unconverged: int
    rmse: Mapping[str, float]
    samples: Mapping[str, int]
    notes: tuple[str, ...] = ()

    def record(self, run: Prepared) -> SimulatedRun:
        """Return the run's record in `simulation.json`."""
        start = run.drive.start_f_in_N
        return SimulatedRun(
            solver=self.solver,
            conditioning=run.conditioning(),
            start="at rest" if start is None else f"f_in_N = {start:.4g} N as measured",
            samples=self.rows,
            slack_samples=self.slack,
            unconverged_samples=self.unconverged,
            notes=self.notes,
            channels={
                name: SimulatedChannel(
                    rmse=self.rmse[name],
                    noise=run.noise[name],
                    samples=self.samples[name],
                    unit=BY_NAME[name].unit,
                )
                for name in self.rmse
            },
        )


def compare(
    run: Prepared, model: Model, dynamics: Dynamics = "slip", nodes: int | None = None
) -> Compared:
    """Return a model's prediction of a run and its residual.

    With `nodes` a chain of that many is used in place of the closed form.

    Raises
    ------
    InputError
        The static model with a load that is not a spring, or with a drive by force.
    """
    refuse_static(run.run, run.drive_column, dynamics)
    response = simulate(
        model.rig(run.run),
        run.drive,
        dynamics,
        on_mesh=nodes is not None,
        nodes=nodes,
        tolerance=run.step_tolerance,
    )
    channels = channels_of(response, set(run.conditioned), run.in_gap)
    residual = {name: run.measured[name] - channels[name] for name in run.measured}
    residual = {name: r[np.isfinite(r)] for name, r in residual.items()}
    return Compared(
        response,
        channels,
        {name: float(np.sqrt(np.mean(r**2))) for name, r in residual.items()},
        {name: int(r.size) for name, r in residual.items()},
        tuple(dynamic_notes(run, model, response)) if dynamics == "lugre" else (),
    )


def refuse_static(run: Run, drive_column: str, dynamics: Dynamics) -> None:
    """Refuse the static model where it is not valid.

    Raises
    ------
    InputError
        The load is not a spring, or the drive is by force.
    """
    valid = run.load == "spring" and drive_column == "x_in_mm"
    if dynamics == "static" and not valid:
        raise InputError(
            "the static model is valid for a spring load and a drive by displacement only",
            where=f"run {run.id}",
            remedy="use --dynamics slip",
        )


def channels_of(
    response: Prediction, driven: Set[str], in_gap: npt.NDArray[np.bool_]
) -> dict[str, Floats]:
    """Return the channels that a model predicts, NaN in gaps of the drive."""
    predicted = {
        "f_in_N": response.f_in_N,
        "f_out_N": response.f_out_N,
        "x_out_mm": response.x_out_mm,
    }
    return {
        name: np.where(in_gap, np.nan, values)
        for name, values in predicted.items()
        if name not in driven
    }
