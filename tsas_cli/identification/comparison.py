"""A model's prediction of one run, its residual, and notes on what makes it unreliable."""

import math
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import MOST_PER_SAMPLE, MOST_TRIES
from tsas_cli.physics.lugre.stability import Stability, stability
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import Dynamics, Prediction, simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Run
from tsas_cli.records.simulation import SimulatedChannel, SimulatedRun
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError


@dataclass(frozen=True)
class RunSummary:
    """Figures of one simulated run, or of a part: the solver, the samples, the squared residuals.

    `squares` are their sums by channel, over so many `samples`.
    """

    solver: str
    rows: int
    slack: int
    unconverged: int
    squares: Mapping[str, float]
    samples: Mapping[str, int]
    notes: tuple[str, ...] = ()

    @property
    def rmse(self) -> dict[str, float]:
        """Root mean square of each channel's residual, NaN without samples."""
        return {
            name: math.sqrt(square / self.samples[name]) if self.samples[name] else math.nan
            for name, square in self.squares.items()
        }

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


@dataclass(frozen=True)
class Compared:
    """One run simulated; `channels` are the predictions, shape (n,), NaN in gaps of the drive."""

    response: Prediction
    channels: dict[str, Floats]
    summary: RunSummary


def summary_of(
    response: Prediction,
    channels: Mapping[str, Floats],
    measured: Mapping[str, Floats],
    notes: Iterable[str] = (),
) -> RunSummary:
    """Return the figures of a run's prediction, or of a part of it."""
    residual = {name: values - channels[name] for name, values in measured.items()}
    residual = {name: r[np.isfinite(r)] for name, r in residual.items()}
    return RunSummary(
        response.solver,
        response.phase.size,
        int(np.count_nonzero(response.phase == SLACK)),
        int(np.count_nonzero(response.phase == UNCONVERGED)),
        {name: float(np.sum(r**2)) for name, r in residual.items()},
        {name: r.size for name, r in residual.items()},
        tuple(notes),
    )


def compare(
    run: Prepared, model: Model, dynamics: Dynamics = "slip", nodes: int | None = None
) -> Compared:
    """Return a model's prediction of a run and its residual.

    With `nodes` a chain of that many is used in place of the closed form.

    InputError: the static model with a load that is not a spring, or with a drive by force; an
    antagonist with another than the distributed model.
    """
    refuse_invalid(run.run, model, run.drive_column, dynamics)
    response = simulate(
        model.rig(run.run), run.drive, dynamics, nodes=nodes, tolerance=run.step_tolerance
    )
    channels = channels_of(response, set(run.conditioned), run.in_gap)
    notes = dynamic_notes(run, model, response) if dynamics == "lugre" else ()
    return Compared(response, channels, summary_of(response, channels, run.measured, notes))


def refuse_invalid(run: Run, model: Model, drive_column: str, dynamics: Dynamics) -> None:
    """Refuse the static model for a load that is no spring, or a drive by force; two tendons too.

    The dynamic model has one tendon alone as well.
    """
    if dynamics != "slip" and model.rig(run).effects.antagonist.preload_N != 0.0:
        raise InputError(
            "antagonist is in the model, which the static and the dynamic model do not have",
            where=f"run {run.id}",
            remedy="use --dynamics slip",
        )
    valid = run.load == "spring" and drive_column == "x_in_mm"
    if dynamics == "static" and not valid:
        raise InputError(
            "the static model is valid for a spring load and a drive by displacement only",
            where=f"run {run.id}",
            remedy="use --dynamics slip",
        )


def channels_of(response: Prediction, driven: Set[str], in_gap: Mask) -> dict[str, Floats]:
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


MANY_STEPS = 10  # steps for each sample
HIGH_DAMPING = 3.0  # times critical, from which the bristles are the cause of unstable sliding


def dynamic_notes(run: Prepared, model: Model, response: Prediction) -> Iterator[str]:
    """Yield notes on what makes the dynamic model's prediction of a run unreliable."""
    rig = model.rig(run.run)
    if model.value("bristles.stiffness_N_per_mm") is None:
        yield (
            "the bristles are those of Yang 2025, Table 1: the model has no "
            "[bristles.stiffness_N_per_mm] of this rig"
        )
    yield from unstable_sliding(rig, run.time_s, run.drive)
    steps, samples = response.step_ends_s.size, run.time_s.size
    if steps > MANY_STEPS * samples:
        yield (
            f"{steps} steps for {samples} samples: the tendon sticks and slips, or its load rings, "
            "much faster than the sampling resolves"
        )
    aborted = response.phase == UNCONVERGED
    if np.any(aborted):
        yield (
            f"aborted at {run.time_s[np.argmax(aborted)]:.4g} s, after {MOST_TRIES} steps and "
            f"{MOST_PER_SAMPLE} more for each sample: later samples are not simulated"
        )


def unstable_sliding(rig: Rig, time_s: Floats, drive: DriveInput) -> Iterator[str]:
    """Yield a note on the most unstable moment of sliding in a run, if there is one."""
    slow = simulate(rig, drive)
    found = stability(rig, time_s, slow.x_in_mm, slow.f_in_N, slow.phase)
    if found is not None and found.unstable:
        yield _unstable(found, rig)


def _unstable(found: Stability, rig: Rig) -> str:
    moment = found.moment
    where = "where the whole tendon slides" if moment.whole else "in a dead band"
    sentence = (
        f"sliding is unstable {where}, at {moment.speed_mm_s:.3g} mm/s and f_in of "
        f"{moment.f_in_N:.3g} N: a disturbance grows e-fold in {1e3 / found.growth_per_s:.2g} ms"
    )
    critical = rig._replace(bristles=rig.bristles._replace(damping_N_s_per_mm=math.nan))
    ratio = bristles_of(rig).damping / bristles_of(critical).damping
    if ratio > HIGH_DAMPING:
        return (
            f"{sentence}; the bristles' damping is {ratio:.3g} times critical; without "
            "[bristles.damping_N_s_per_mm] it is critical"
        )
    return f"{sentence}; friction falls with speed by more than the damping"
