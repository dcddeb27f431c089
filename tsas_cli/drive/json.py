"""What `drive.json` says of an identified drive (docs/formats.md)."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.drive.diagnosis import DriveCause, DriveDiagnosis
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.fit import LINEAR, Terms, quantities_of
from tsas_cli.drive.frequency_response import FrequencyResponse
from tsas_cli.drive.search import DriveSearch, structures
from tsas_cli.drive.transfer_function import bode_curve, poles
from tsas_cli.drive.words import (
    name_of,
    next_run,
)
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.physics.plant.harmonic_drive import DriveValues

Floats = npt.NDArray[np.float64]

CURVE_POINTS = 200
BESIDE_BAND = 1.05  # of its edge, up to which a pole counts as inside


def structure_rows(search: DriveSearch, final: Terms) -> list[dict[str, Any]]:
    """Return every structure that was fitted with what is in the gear, the simplest first."""
    gear = final - frozenset(LINEAR)
    rows = []
    for terms in structures(gear):
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


def kinematics(sheet: DataSheet, fitted: dict[str, Estimate]) -> dict[str, Any]:
    """Return the lead of the motor's speed over x_in, as fitted and by kinematics alone."""
    K, lead = sheet.kinematic_gain, fitted["kV_rpm_s_per_mm"]
    return {
        "kinematic_gain_mm_per_s_rpm": K,
        "kinematic_lead_rpm_s_per_mm": None if K is None else 1.0 / K,
        "fitted_lead_rpm_s_per_mm": lead.value,
        "fitted_above_kinematic_percent": None if K is None else 100.0 * (lead.value * K - 1.0),
    }


def response(seen: FrequencyResponse, values: DriveValues) -> dict[str, Any]:
    """Return the frequency response, measured and fitted, on the same turn of the phase."""
    at = seen.frequency_Hz
    measured_response = seen.response
    curve = np.geomspace(at[0], at[-1], CURVE_POINTS)
    magnitude, phase = bode_curve(values, curve)
    measured = np.degrees(np.unwrap(np.angle(measured_response)))
    excited = np.flatnonzero(seen.excited)
    if excited.size:  # the same turn as the fitted curve
        k = int(excited[0])
        off = measured[k] - float(np.interp(at[k], curve, phase))
        measured -= 360.0 * round(off / 360.0)
    return {
        "band_Hz": None if seen.band is None else list(seen.band),
        "measured": {
            "frequency_Hz": at,
            "magnitude": np.abs(measured_response),
            "phase_deg": measured,
            "coherence": seen.coherence,
            "excited": seen.excited.tolist(),
        },
        "fitted": {"frequency_Hz": curve, "magnitude": magnitude, "phase_deg": phase},
    }


def pole_rows(values: DriveValues, seen: FrequencyResponse) -> list[dict[str, Any]]:
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


def run_rows(search: DriveSearch, fitted: list[Floats], nominal: list[Floats]) -> dict[str, Any]:
    """Return by run how far the simulated x_in is from the measured one."""
    out = {}
    for run, by_fit, by_nominal in zip(search.bench.runs, fitted, nominal, strict=True):
        errors = {"rmse": by_fit - run.x_in, "rmse_nominal": by_nominal - run.x_in}
        out[run.id] = {
            "samples": int(run.counts.sum()),
            "rate_Hz": 1.0 / run.u.step_s,
            "noise": run.noise_mm,
            "unit": "mm",
            **{key: float(np.sqrt(np.nanmean(e**2))) for key, e in errors.items()},
            "begins_at_rest": run.at_rest,
        }
    return out


def diagnosis(search: DriveSearch, found: DriveDiagnosis) -> dict[str, Any]:
    """Return the verdict, what is named, and what it rests on."""
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
