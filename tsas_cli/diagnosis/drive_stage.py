"""The identify-harmonic-drive stage: `drive.toml`, `drive.json` and the simulated x_in."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli import __version__
from tsas_cli.diagnosis.drive_diagnosis import DriveCause, DriveDiagnosis, diagnose_drive
from tsas_cli.diagnosis.drive_search import DriveSearch
from tsas_cli.diagnosis.drive_tables import tables
from tsas_cli.diagnosis.drive_words import (
    cannot_tell,
    equation_of,
    inverse_of,
    name_of,
    next_run,
)
from tsas_cli.effects import EFFECTS
from tsas_cli.files import folder_if, write_json
from tsas_cli.identification.drive_estimates import (
    DataSheet,
    drive_sheet,
    estimates_of,
)
from tsas_cli.identification.drive_file import FILE, UNITS, IdentifiedDrive, drive_of, write_drive
from tsas_cli.identification.drive_fit import LINEAR, DriveBench, Terms, quantities_of
from tsas_cli.identification.drive_runs import drive_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.frequency_response import FrequencyResponse, frequency_response
from tsas_cli.identification.transfer_function import bode_curve, poles
from tsas_cli.numerics.linear_response import Hold
from tsas_cli.physics.drive import DriveValues
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_runs
from tsas_cli.result import Result, Table, notes
from tsas_cli.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]

CURVE_POINTS = 200
BESIDE_BAND = 1.05  # of its edge, up to which a pole counts as inside


@dataclass(frozen=True, repr=False, eq=False)
class DriveResult(Result):
    """An identified drive, what the nominal drive equation lacks, and the simulated runs.

    Parameters
    ----------
    estimates
        Every parameter by name: fitted, derived, or given by the data sheet.
    diagnosis
        The verdict on the nominal drive equation, with causes and gains on held-out data.
    runs
        By id the simulated runs: columns of shape (n,) as in the recording, `x_in_mm` and that of
        the nominal drive, `x_in_nominal_mm` [mm].
    """

    estimates: Mapping[str, Estimate]
    diagnosis: DriveDiagnosis
    runs: Mapping[str, Recording]

    @property
    def drive(self) -> IdentifiedDrive:
        """The drive as `drive.toml` holds it, for the controllers of `track`."""
        known = self.estimates.items()
        return drive_of({n: e.value for n, e in known if math.isfinite(e.value)})

    def __getitem__(self, run: str) -> Recording:
        """Return a simulated run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return structures, parameters, errors and causes."""
        return tables(self.summary, self.titled(self.summary["structure"]["equation"], FILE))

    def sentences(self) -> list[str]:
        """Return the verdict, the inverse, what to measure next, and what cannot be told."""
        found = self.summary["diagnosis"]
        return [
            found["reason"],
            self.summary["inverse"],
            f"Next: {found['next_experiment']}",
            *notes(self.summary["cannot_tell"]),
        ]


def identify_drive(
    dataset: Dataset,
    out: Path | None,
    hold: Hold = "first",
    *,
    force: bool = False,
    step: Steps = SILENT,
) -> DriveResult:
    """Identify and diagnose a drive.

    `drive.toml`, `drive.json` and `runs/ID.parquet` are written into a new folder if there is one.

    Raises
    ------
    InputError
        A recording does not serve (`drive_runs`), or `out` exists and `force` is not set.
    """
    with folder_if(out, force=force) as folder:
        step.ahead(2)
        runs = drive_runs(dataset, hold)
        step()
        seen, sheet = frequency_response(runs), drive_sheet(dataset.manifest)
        search = DriveSearch(DriveBench(runs, seen, sheet.stated_frequency), step)
        final = search.run()
        trial, folds = search.trial(final), search.folds
        blocks = [folds.block[folds.run == k] for k in range(len(runs))]
        counted = [np.unique(block, return_inverse=True)[1] for block in blocks]
        fitted = estimates_of(trial, counted, sheet, by_run=folds.by_run)
        found = diagnose_drive(search, final, fitted)
        by_fit, by_nominal = _simulated(search, final), _simulated(search, found.nominal)
        known = fitted | _given(sheet)
        summary = dataset.header("identify-harmonic-drive", out) | {
            "hold": hold,
            "structure": {"name": name_of(final), "equation": equation_of(final)},
            "structures": _structures(search, final),
            "parameters": [e.as_json() for e in known.values()],
            "kinematics": _kinematics(sheet, fitted),
            "inverse": inverse_of(trial.values),
            "frequency_response": _response(seen, trial.values),
            "poles": _poles(trial.values, seen),
            "runs": _runs(search, by_fit, by_nominal),
            "fit": {
                "converged": trial.solution.converged,
                "message": trial.solution.message,
                "evaluations": trial.solution.evaluations,
            },
            "diagnosis": _diagnosis(search, found),
        }
        summary["cannot_tell"] = cannot_tell(summary, sheet, final, known)
        step()
        simulated = _recordings(dataset.runs, search, by_fit, by_nominal)
        if folder is not None:
            write_json(folder / "drive.json", summary)
            structure, of = {"name": name_of(final), "hold": hold}, summary["dataset"]
            write_drive(folder / FILE, known, structure, version=__version__, dataset=of)
            write_runs(folder / "runs", simulated)
    return DriveResult(summary, out, known, found, simulated)


def _given(sheet: DataSheet) -> dict[str, Estimate]:
    stated = {
        "turntable_radius_mm": sheet.turntable_radius_mm,
        "gear_ratio": sheet.gear_ratio,
        "inertia_N_mm_s2": sheet.inertia_N_mm_s2,
    }
    return {
        name: Estimate(name, value, UNITS[name], "data sheet")
        for name, value in stated.items()
        if value is not None
    }


def _structures(search: DriveSearch, final: Terms) -> list[dict[str, Any]]:
    """Return every structure that was fitted with what is in the gear, the simplest first."""
    gear = final - frozenset(LINEAR)
    rows = []
    for terms in search.structures(gear):
        trial = search.trial(terms)
        rows.append(
            {
                "name": name_of(terms),
                "parameters": len(quantities_of(terms)),
                "held_out_times_noise": math.sqrt(search.mean_square(terms)),
                "times_noise": math.sqrt(trial.mean_square),
                "converged": trial.solution.converged,
                "chosen": terms == final,
            }
        )
    return rows


def _kinematics(sheet: DataSheet, fitted: dict[str, Estimate]) -> dict[str, Any]:
    K, lead = sheet.kinematic_gain, fitted["kV_rpm_s_per_mm"]
    return {
        "kinematic_gain_mm_per_s_rpm": K,
        "kinematic_lead_rpm_s_per_mm": None if K is None else 1.0 / K,
        "fitted_lead_rpm_s_per_mm": lead.value,
        "fitted_above_kinematic_percent": None if K is None else 100.0 * (lead.value * K - 1.0),
    }


def _response(seen: FrequencyResponse, values: DriveValues) -> dict[str, Any]:
    at = seen.frequency_Hz
    told = seen.response
    curve = np.geomspace(at[0], at[-1], CURVE_POINTS)
    magnitude, phase = bode_curve(values, curve)
    measured = np.degrees(np.unwrap(np.angle(told)))
    excited = np.flatnonzero(seen.excited)
    if excited.size:  # the same turn as the fitted curve
        k = int(excited[0])
        off = measured[k] - float(np.interp(at[k], curve, phase))
        measured -= 360.0 * round(off / 360.0)
    return {
        "band_Hz": None if seen.band is None else list(seen.band),
        "measured": {
            "frequency_Hz": at,
            "magnitude": np.abs(told),
            "phase_deg": measured,
            "coherence": seen.coherence,
            "excited": seen.excited.tolist(),
        },
        "fitted": {"frequency_Hz": curve, "magnitude": magnitude, "phase_deg": phase},
    }


def _poles(values: DriveValues, seen: FrequencyResponse) -> list[dict[str, Any]]:
    """Return the poles, and 1/T of a delay, with whether the input shows their frequency."""
    band = seen.band
    out = []
    for pole in poles(values):
        if abs(pole) < 1e-9 or pole.imag < 0.0:
            continue
        out.append(("pole", float(pole.real), float(pole.imag), float(abs(pole)) / (2.0 * math.pi)))
    if values.delay_s > 0.0:
        rate = 1.0 / values.delay_s
        out.append(("1/delay", -rate, 0.0, rate / (2.0 * math.pi)))
    return [
        {
            "kind": kind,
            "real_per_s": real,
            "imaginary_per_s": imaginary,
            "frequency_Hz": frequency,
            "in_band": band is not None
            and band[0] / BESIDE_BAND <= frequency <= band[1] * BESIDE_BAND,
        }
        for kind, real, imaginary, frequency in out
    ]


def _simulated(search: DriveSearch, terms: Terms) -> list[Floats]:
    """Return x_in of every run by a set of terms."""
    values = search.trial(terms).values
    return [search.bench.simulated(r, values) for r in range(len(search.bench.runs))]


def _runs(search: DriveSearch, fitted: list[Floats], nominal: list[Floats]) -> dict[str, Any]:
    out = {}
    for run, by_fit, by_nominal in zip(search.bench.runs, fitted, nominal, strict=True):
        errors = {"rmse": by_fit - run.x_in, "rmse_nominal": by_nominal - run.x_in}
        out[run.id] = {
            "samples": int(run.x_in.size),
            "rate_Hz": 1.0 / run.u.step_s,
            "noise": run.noise_mm,
            "unit": "mm",
            **{key: float(np.sqrt(np.mean(e**2))) for key, e in errors.items()},
            "begins_at_rest": run.at_rest,
        }
    return out


def _diagnosis(search: DriveSearch, found: DriveDiagnosis) -> dict[str, Any]:
    folds = search.folds
    how = "Each run is predicted by a fit to the others"
    if not folds.by_run:
        how = "Stretches are predicted by a fit to the rest"
    return {
        "verdict": found.verdict,
        "reason": found.reason,
        "nominal": "Eq. (25) without reaction" if found.nominal else "x_in = g ∫u dt",
        "named": [_cause(cause) for cause in found.causes],
        "gain_percent": found.gain_percent[0],
        "gain_interval_percent": list(found.gain_percent[1:]),
        "channels": {"x_in_mm": {"unit": "mm", **vars(found.channel)}},
        "remainder": {
            "unexplained": found.unexplained,
            "depends_on": list(found.depends_on),
            "share_percent": 100.0 * found.share_left,
            "mean_square": found.mean_square,
        },
        "evidence": {
            "held_out": "runs" if folds.by_run else "stretches",
            "blocks": folds.blocks,
            "sentence": f"{how}; {folds.blocks} blocks longer than the error's memory count.",
        },
        "next_experiment": next_run(found),
    }


def _cause(cause: DriveCause) -> dict[str, Any]:
    effect = next(e for e in EFFECTS if e.name == cause.effect)
    return {
        "effect": cause.effect,
        "title": effect.title,
        "kind": cause.kind,
        "rivals": list(cause.rivals),
        "parameters": {
            e.name: {k: v for k, v in e.as_json().items() if k not in ("name", "run", "origin")}
            for e in cause.parameters
        },
        "gain_percent": cause.gain_percent,
        "gain_interval_percent": list(cause.gain_interval_percent),
    }


def _recordings(
    entries: list[Run], search: DriveSearch, fitted: list[Floats], nominal: list[Floats]
) -> dict[str, Recording]:
    """Return the simulated runs."""
    simulated = {}
    each = zip(entries, search.bench.runs, fitted, nominal, strict=True)
    for entry, run, by_fit, by_nominal in each:
        columns = {"time_s": run.time_s, "x_in_mm": by_fit, "x_in_nominal_mm": by_nominal}
        simulated[entry.id] = Recording(entry, columns)
    return simulated
