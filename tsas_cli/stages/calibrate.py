"""The calibrate stage: `model.toml` and `calibration.json` of a dataset."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from tsas_cli.identification.calibration import Calibration, calibrate_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.long_runs import open_long
from tsas_cli.identification.model import (
    FILE,
    Model,
    data_sheet,
    fitted_to,
    source_of,
    stated_model,
    write_model,
)
from tsas_cli.identification.phases import segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.identification.stiffness import Slope
from tsas_cli.physics.capstan import dead_band_stiffness, slip_stiffness, speed_per_stiffness
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.quality.checks import sign
from tsas_cli.recordings.quality.finding import CannotTell, Remark
from tsas_cli.recordings.quality.stretches import look_by_stretches
from tsas_cli.recordings.quality.trial import Trial
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, one_of, path_of
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import folder_if, write_json
from tsas_cli.support.steps import SILENT, Steps

DYNAMICS: tuple[Literal["slip", "lugre"], ...] = ("slip", "lugre")


@dataclass(frozen=True, repr=False, eq=False)
class CalibrationResult(Result):
    """A calibrated model, and what was found on the way.

    Parameters
    ----------
    calibration
        The calibrated model and, run by run, phases, slopes and answers.
    """

    calibration: Calibration

    @property
    def model(self) -> Model:
        """The calibrated model: every parameter with its interval and unit."""
        return self.calibration.model

    def tables(self) -> list[Table]:
        """Return the slopes, the parameters and the errors."""
        return _tables(self.summary, self.titled("parameters", FILE))

    def sentences(self) -> list[str]:
        """Return what these recordings do not say, and why."""
        return notes(self.summary["cannot_tell"])


def calibrate(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    dynamics: Literal["slip", "lugre"] = "slip",
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = SILENT,
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
    force
        Replace the folder if it is there.
    step
        Told of two pieces of work per run, and of every fit.

    Returns
    -------
    CalibrationResult
        `.model` holds every parameter with unit and 95 % interval; `.calibration` what was found
        on the way, run by run: `segments` (phases), `slopes` (km [N/mm]), `answers` (simulated
        channels, shape (n,)); `.summary` is what `calibration.json` holds.

    Raises
    ------
    InputError
        A recording or the model is wrong, a channel has the wrong sign, or `out` exists and
        `force` is not set.
    """
    taken = one_of(DYNAMICS, dynamics, "dynamics")
    data, given, path = dataset_of(dataset, runs), path_of(model), path_of(out)
    stated = stated_model(data.manifest, given)
    with folder_if(path, stage="calibrate", inputs=[data.folder, given], force=force) as folder:
        step.ahead(len(data.runs))
        prepared = []
        for run in data.runs:
            prepared.append(_prepared(data, run))
            step()
        result = calibrate_runs(data.manifest, prepared, step, dynamics=taken, stated=stated)
        summary = data.header("calibrate", path) | {"model": source_of(given, path)}
        summary["dynamics"] = taken
        summary |= _summary(result, data.manifest)
        if folder is not None:
            write_model(
                folder / FILE, result.model, version=__version__, dataset=fitted_to(summary)
            )
            write_json(folder / "calibration.json", summary)
    return CalibrationResult(summary, path, result)


def _prepared(dataset: Dataset, run: Run) -> Prepared:
    """Return a run that is ready for the fit; of a long one the samples that the fit takes."""
    long, rig = open_long(dataset, run), dataset.manifest.rig
    if long is not None:
        _refuse_wrong_sign(look_by_stretches((sign.CHECK,), long.columns, rig)["sign"], run)
        return long.prepared()
    recording = dataset[run.id]
    _refuse_wrong_sign(sign.find(Trial(recording, rig)), run)
    return prepare(recording, dataset.manifest.session_start)


def _refuse_wrong_sign(said: Iterable[Remark | CannotTell], run: Run) -> None:
    """Stop at what no parameter mends: a fit would end somewhere, and mean nothing."""
    for one in said:
        if isinstance(one, Remark):
            raise InputError(one.sentence, where=run.file, remedy=one.remedy)


def _summary(result: Calibration, manifest: Manifest) -> dict[str, Any]:
    return {
        "segments": {
            run.run.id: segments_as_json(run, segments)
            for run, segments in zip(result.runs, result.segments, strict=True)
        },
        "stiffness": [
            _stiffness(run, slope, expected, manifest, result.model)
            for run, slopes, by_model in zip(
                result.runs, result.slopes, result.expected, strict=True
            )
            for slope in slopes
            for expected in [next((e for e in by_model if e.phase == slope.phase), None)]
        ],
        "transfer": [e.as_json() for e in result.transfer],
        "parameters": [e.as_json() for e in result.model.estimates],
        "cannot_tell": list(result.cannot_tell),
        "fit": {
            "converged": result.fitted is not None and result.fitted.converged,
            "message": "nothing to fit" if result.fitted is None else result.fitted.message,
            "evaluations": 0 if result.fitted is None else result.fitted.evaluations,
            "solver": sorted({a.response.solver for a in result.predictions}),
        },
        "channels": {
            run.run.id: {
                name: {"rmse": rmse, "noise": run.noise[name]} for name, rmse in a.rmse.items()
            }
            for run, a in zip(result.runs, result.predictions, strict=True)
        },
    }


def _stiffness(
    run: Prepared, slope: Slope, expected: Slope | None, manifest: Manifest, model: Model
) -> dict[str, Any]:
    """Return one row: measured km and kr beside what theory and the calibrated model expect."""
    sheet = manifest.rig
    stated = all(
        v is not None
        for v in (
            sheet.friction_coefficient,
            sheet.tendon_modulus_GPa,
            sheet.tendon_diameter_mm,
            sheet.load_stiffness_N_per_mm,
            run.run.total_bend_rad,
            run.run.sheath_length_mm,
        )
    )
    theory, elastic = _theory((data_sheet(manifest) if stated else model).rig(run.run), slope, run)
    radius, gear = sheet.turntable_radius_mm, sheet.gear_ratio
    factor = None if radius is None or gear is None else speed_per_stiffness(radius, gear)
    return {
        "run": run.run.id,
        "phase": slope.phase,
        "km": _estimate("km", slope, "N/mm", 1.0, run.run.id).as_json(),
        "kr": None
        if factor is None
        else _estimate("kr", slope, "N/(s rpm)", factor, run.run.id).as_json(),
        "theory_N_per_mm": theory,
        "theory_elastic_N_per_mm": elastic,
        "expected_N_per_mm": None if expected is None else expected.value,
        "occurrences": slope.occurrences,
        "samples": slope.samples,
        "note": "theory from the data sheet" if stated else "theory from the calibrated values",
    }


def _estimate(name: str, slope: Slope, unit: str, factor: float, run: str) -> Estimate:
    low, high = slope.value - slope.half_width, slope.value + slope.half_width
    return Estimate(
        name,
        slope.value * factor,
        unit,
        "fitted",
        run,
        slope.stderr * factor,
        low * factor,
        high * factor,
    )


def _theory(rig: Rig, slope: Slope, run: Prepared) -> tuple[float | None, float | None]:
    """Return km by Eqs. (29), (31), (32), and with the elastic term kept (30)."""
    import math

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


def _tables(summary: dict[str, Any], title: str) -> list[Table]:
    """Return the slopes, the parameters under their title, and the errors."""
    parameters = [Estimate(**p) for p in summary["parameters"]]
    slope_rows = [
        (
            row["run"],
            row["phase"],
            Estimate(**row["km"]).text(),
            _number(row["theory_N_per_mm"]),
            _number(row["expected_N_per_mm"]),
        )
        for row in summary["stiffness"]
    ]
    error_rows = [
        (run, name, f"{c['rmse']:.4g}", f"{c['noise']:.2g}")
        for run, channels in summary["channels"].items()
        for name, c in channels.items()
    ]
    return [
        (
            "stiffness km [N/mm] by linear fit",
            ("run", "phase", "measured [95 %]", "theory", "distributed model"),
            slope_rows,
        ),
        *_transfer_table(summary["transfer"]),
        (
            title,
            ("name", "run", "value [95 %]", "unit"),
            [(e.name, e.run or "all", e.text(), e.unit) for e in parameters],
        ),
        ("calibrated model against measurement", ("run", "channel", "RMSE", "noise"), error_rows),
    ]


def _transfer_table(transfer: Sequence[dict[str, Any]]) -> list[Table]:
    rows = [(p["run"], p["name"], Estimate(**p).text(), p["unit"]) for p in transfer]
    title = "tension passed on in full slip, f_in = ratio f_out + intercept"
    return [(title, ("runs", "name", "value [95 %]", "unit"), rows)] if rows else []


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"
