"""The calibrate stage: `model.toml` and `calibration.json` of a dataset."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from tsas_cli.identification.calibration import Calibration, calibrate_runs
from tsas_cli.identification.fitted_to import fitted_to
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.model_file import source_of, stated_model, write_model
from tsas_cli.identification.phases import segment_records
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.transfer import Slope
from tsas_cli.physics.closed_form.capstan import (
    dead_band_stiffness,
    slip_stiffness,
    speed_per_stiffness,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality.copies.deduplicated import without_duplicates
from tsas_cli.records import calibration as records
from tsas_cli.records.base import ParameterValue, number_text, parameters_of, span_text
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.before_fit import errors_and_warnings, prepared_runs
from tsas_cli.stages.given import Named, dataset_of, path_of
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps

FEW = 5  # runs whose own parameters are printed


@dataclass(frozen=True, repr=False, eq=False)
class CalibrationResult(Result):
    """A calibrated model, and what was found on the way."""

    record: records.CalibrationFile  # what `calibration.json` holds
    calibration: Calibration  # and, run by run, phases, slopes and predictions

    @property
    def model(self) -> Model:
        """The calibrated model: every parameter with its interval and unit."""
        return self.calibration.model

    def tables(self) -> Iterator[Table]:
        """Yield the slopes, the parameters and the errors."""
        slopes = [
            (
                row.run,
                row.phase,
                row.km.text(),
                number_text(row.theory_N_per_mm, ".4g"),
                number_text(row.expected_N_per_mm, ".4g"),
            )
            for row in self.record.stiffness
        ]
        header = ("run", "phase", "measured [95 %]", "theory", "distributed model")
        yield "stiffness km [N/mm] by linear fit", header, slopes
        transfer = [
            (_few(p.run or "", len(self.record.channels)), p.name, p.text(), p.unit)
            for p in self.record.transfer
        ]
        if transfer:
            about = "tension passed on in full slip, f_in = ratio f_out + intercept"
            yield about, ("runs", "name", "value [95 %]", "unit"), transfer
        taken = [p for p in self.record.parameters if p.run in (None, *self.record.channels)]
        of_runs: dict[str, list[float | None]] = {}
        for p in taken:
            of_runs.setdefault(p.name, []).append(p.value)
        parameters = dict.fromkeys(  # of many runs one row: the file holds each
            (p.name, p.run or "all", p.text(), p.unit)
            if len(of := of_runs[p.name]) <= FEW
            else (p.name, f"{len(of)} runs", span_text(of), p.unit)
            for p in taken
        )
        yield (
            self.titled("parameters", records.MODEL_FILE),
            ("name", "run", "value [95 %]", "unit"),
            [*parameters],
        )
        errors = [
            (run, name, number_text(c.rmse, ".4g"), number_text(c.noise, ".2g"))
            for run, channels in self.record.channels.items()
            for name, c in channels.items()
        ]
        yield "calibrated model against measurement", ("run", "channel", "RMSE", "noise"), errors

    def sentences(self) -> list[str]:
        """Return what these recordings do not say, and why."""
        return notes([*self.record.accepted(), *self.record.warned(), *self.record.cannot_tell])


def _few(runs: str, of: int) -> str:
    """Return a list of runs for a table: the first one of many, and whether they are all."""
    first, *others = runs.split(", ")
    if len(others) + 1 == of > 1:
        return "all"
    return f"{first} and {len(others)} more" if len(others) > 1 else runs


def calibrate(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    dynamics: Literal["slip", "lugre"] = "slip",
    runs: Iterable[str] | None = None,
    despite: str | Iterable[str] = (),
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> CalibrationResult:
    """Fit the nominal model to a dataset, and the stiffness km of each phase.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `model.toml` and `calibration.json`; None writes nothing.
    model
        A model to begin with, or its file, whose effects stay; the data sheet's without it.
    dynamics
        `slip`: the distributed model; `lugre`: the dynamic one, with bristles and speed.
    runs
        The ids of the runs that are taken; all without it.
    despite
        Codes of checks whose errors are accepted (`tsas.check`); any other error stops it.
    force
        Replace the folder if it is there.
    step
        Called twice for each run, and for every fit.

    Returns
    -------
    CalibrationResult
        `.model` holds every parameter with unit and 95 % interval; `.calibration` what was found
        on the way, run by run: `segments` (phases), `slopes` (km [N/mm]), `predictions` (simulated
        channels, shape (n,)); `.summary` is what `calibration.json` holds.

    Raises
    ------
    InputError
        A recording or the model is wrong, the checks find an error, or `out` exists and
        `force` is not set.
    """
    data, given, path = dataset_of(dataset, runs), path_of(model, Model), path_of(out)
    stated = stated_model(data.manifest, given)
    with folder_if(path, stage="calibrate", inputs=[data.folder, given], force=force) as folder:
        checked = errors_and_warnings(data, despite, step)
        counted = without_duplicates(data)
        step.ahead(len(counted.dataset.runs))
        prepared = prepared_runs(counted, step, thinned=True)
        result = calibrate_runs(data.manifest, prepared, step, dynamics=dynamics, stated=stated)
        record = records.CalibrationFile(
            **counted.dataset.header(path),
            **checked,
            model=source_of(given, path),
            dynamics=dynamics,
            segments={
                run.run.id: segment_records(run, segments)
                for run, segments in zip(result.runs, result.segments, strict=True)
            },
            stiffness=tuple(_stiffness_rows(result, data.manifest)),
            transfer=parameters_of(result.transfer),
            parameters=parameters_of(result.model.estimates),
            cannot_tell=(*counted.notes, *result.cannot_tell),
            fit=_fit(result),
            channels={
                run.run.id: {
                    name: records.ChannelError(rmse=rmse, noise=run.noise[name])
                    for name, rmse in a.summary.rmse.items()
                }
                for run, a in zip(result.runs, result.predictions, strict=True)
            },
        )
        if folder is not None:
            fitted = record.source().content()
            write_model(
                folder / records.MODEL_FILE,
                result.model,
                version=record.version,
                dataset=fitted,
                fitted_to=fitted_to(data.manifest.rig, prepared),
            )
            record.write(folder)
    return CalibrationResult(record.content(), path, record, result)


def _stiffness_rows(result: Calibration, manifest: Manifest) -> Iterator[records.Stiffness]:
    for run, slopes, by_model in zip(result.runs, result.slopes, result.expected, strict=True):
        expected = {slope.phase: slope for slope in reversed(by_model)}
        for slope in slopes:
            yield _stiffness(run, slope, expected.get(slope.phase), manifest, result.model)


def _fit(result: Calibration) -> records.NominalFit:
    fitted = result.fitted
    return records.NominalFit(
        converged=fitted is not None and bool(fitted.converged),
        message="nothing to fit" if fitted is None else fitted.message,
        evaluations=0 if fitted is None else fitted.evaluations,
        solver=tuple(sorted({a.response.solver for a in result.predictions})),
    )


def _stiffness(
    run: Prepared, slope: Slope, expected: Slope | None, manifest: Manifest, model: Model
) -> records.Stiffness:
    """Return one row: measured km and kr beside what theory and the calibrated model expect."""
    sheet = manifest.rig
    stated = None not in (
        sheet.friction_coefficient,
        sheet.tendon_modulus_GPa,
        sheet.tendon_diameter_mm,
        sheet.load_stiffness_N_per_mm,
        run.run.total_bend_rad,
        run.run.sheath_length_mm,
    )
    theory, elastic = _theory((data_sheet(manifest) if stated else model).rig(run.run), slope, run)
    radius, gear = sheet.turntable_radius_mm, sheet.gear_ratio
    factor = None if radius is None or gear is None else speed_per_stiffness(radius, gear)
    return records.Stiffness(
        run=run.run.id,
        phase=slope.phase,
        km=_parameter("km", slope, "N/mm", 1.0, run.run.id),
        kr=None if factor is None else _parameter("kr", slope, "N/(s rpm)", factor, run.run.id),
        theory_N_per_mm=theory,
        theory_elastic_N_per_mm=elastic,
        expected_N_per_mm=None if expected is None else expected.value,
        occurrences=slope.occurrences,
        samples=slope.samples,
        note="theory from the data sheet" if stated else "theory from the calibrated values",
    )


def _parameter(name: str, slope: Slope, unit: str, factor: float, run: str) -> ParameterValue:
    return ParameterValue(
        name=name,
        value=slope.value * factor,
        unit=unit,
        origin="fitted",
        run=run,
        stderr=slope.stderr * factor,
        interval_low=(slope.value - slope.half_width) * factor,
        interval_high=(slope.value + slope.half_width) * factor,
    )


def _theory(rig: Rig, slope: Slope, run: Prepared) -> tuple[float | None, float | None]:
    """Return km by Eqs. (29), (31), (32), and with the elastic term kept (30)."""
    wrap = rig.friction_coefficient * rig.total_bend_rad
    if wrap <= 0.0:
        return None, None
    if slope.phase.startswith("dead_band"):
        km = dead_band_stiffness(wrap, rig.sheath_length_mm, rig.tendon_stiffness_N)
        return km, km
    if run.run.load != "spring":
        return None, None
    direction = 1.0 if slope.phase == "contraction" else -1.0
    kL = rig.load_stiffness_N_per_mm
    return kL * math.exp(direction * wrap), slip_stiffness(
        wrap, direction, kL, rig.sheath_length_mm, rig.tendon_stiffness_N
    )
