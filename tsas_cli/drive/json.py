"""What `drive.json` says of an identified drive (docs/formats.md), and what is printed of it."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.fit import LINEAR, Terms, quantities_of
from tsas_cli.drive.harmonic_drive import DriveValues, lag_coefficients
from tsas_cli.drive.runs import FrequencyResponse
from tsas_cli.drive.search import DriveSearch, structures
from tsas_cli.drive.sentences import name_of
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records import drive as records
from tsas_cli.records.base import number_text
from tsas_cli.records.diagnosis import errors_table
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.result import Table
from tsas_cli.support.arrays import Complex, Floats

CURVE_POINTS = 200
BESIDE_BAND = 1.05  # of its edge, up to which a pole counts as inside


def structure_rows(search: DriveSearch, final: Terms) -> list[records.TriedStructure]:
    """Return every structure that was fitted with what is in the gear, the simplest first."""
    rows = []
    for terms in structures(final - frozenset(LINEAR)):
        trial = search.trial(terms)
        rows.append(
            records.TriedStructure(
                name=name_of(terms),
                parameters=len(quantities_of(terms)),
                held_out_times_noise=math.sqrt(search.mean_square(terms)),
                times_noise=math.sqrt(trial.mean_square),
                converged=trial.solution.converged,
                chosen=terms == final,
            )
        )
    return rows


def kinematics(sheet: DataSheet, fitted: Mapping[str, Estimate]) -> records.Kinematics:
    """Return the lead of the motor's speed over x_in, as fitted and by kinematics alone."""
    K, lead = sheet.kinematic_gain, fitted["kV_rpm_s_per_mm"]
    return records.Kinematics(
        kinematic_gain_mm_per_s_rpm=K,
        kinematic_lead_rpm_s_per_mm=None if K is None else 1.0 / K,
        fitted_lead_rpm_s_per_mm=lead.value,
        fitted_above_kinematic_percent=None if K is None else 100.0 * (lead.value * K - 1.0),
    )


def response(seen: FrequencyResponse, values: DriveValues) -> records.FrequencyResponses:
    """Return the frequency response, measured and fitted, on the same turn of the phase."""
    at = seen.frequency_Hz
    curve = np.geomspace(at[0], at[-1], CURVE_POINTS)
    magnitude, phase = bode_curve(values, curve)
    measured = np.degrees(np.unwrap(np.angle(seen.response)))
    excited = np.flatnonzero(seen.excited)
    if excited.size:  # the same turn as the fitted curve
        k = int(excited[0])
        off = measured[k] - float(np.interp(at[k], curve, phase))
        measured -= 360.0 * round(off / 360.0)
    return records.FrequencyResponses(
        band_Hz=seen.band,
        measured=records.MeasuredResponse(
            frequency_Hz=at.tolist(),
            magnitude=np.abs(seen.response).tolist(),
            phase_deg=measured.tolist(),
            coherence=seen.coherence.tolist(),
            excited=seen.excited.tolist(),
        ),
        fitted=records.BodeCurve(
            frequency_Hz=curve.tolist(), magnitude=magnitude.tolist(), phase_deg=phase.tolist()
        ),
    )


def pole_rows(values: DriveValues, seen: FrequencyResponse) -> list[records.Pole]:
    """Return the poles, and 1/T of a delay, with whether the input shows their frequency."""
    upper = [pole for pole in poles(values) if abs(pole) >= 1e-9 and pole.imag >= 0.0]
    found = [("pole", complex(pole)) for pole in upper]
    if values.delay_s > 0.0:
        found.append(("1/delay", complex(-1.0 / values.delay_s)))
    low, high = seen.band or (math.inf, -math.inf)
    return [
        records.Pole(
            kind=kind,
            real_per_s=pole.real,
            imaginary_per_s=pole.imag,
            frequency_Hz=(frequency := abs(pole) / (2.0 * math.pi)),
            in_band=low / BESIDE_BAND <= frequency <= high * BESIDE_BAND,
        )
        for kind, pole in found
    ]


def run_rows(
    search: DriveSearch, fitted: list[Floats], nominal: list[Floats]
) -> dict[str, records.DriveRunErrors]:
    """Return by run how far the simulated x_in is from the measured one."""
    return {
        run.id: records.DriveRunErrors(
            samples=int(run.counts.sum()),
            rate_Hz=1.0 / run.u.step_s,
            noise=run.noise_mm,
            rmse=_rms(by_fit - run.x_in),
            rmse_nominal=_rms(by_nominal - run.x_in),
            begins_at_rest=run.at_rest,
        )
        for run, by_fit, by_nominal in zip(search.bench.runs, fitted, nominal, strict=True)
    }


def _rms(error: Floats) -> float:
    return float(np.sqrt(np.nanmean(error**2)))


def transfer_function(values: DriveValues) -> Any:
    """Return G(s) without its delay, a `control.TransferFunction`; Yang 2025, Eqs. (46), (47)."""
    from control import tf

    denominator = np.polymul([1.0, values.leak_per_s], lag_coefficients(values)[::-1])
    return tf([values.gain_mm_per_s_rpm], denominator, inputs="motor speed", outputs="x_in")


def bode_curve(values: DriveValues, frequency_Hz: Floats) -> tuple[Floats, Floats]:
    """Return magnitude [mm per rpm s] and phase [°] of G e^{−Ts}, shapes (m,)."""
    w = 2.0 * math.pi * frequency_Hz
    response = transfer_function(values).frequency_response(w)
    phase = np.unwrap(np.atleast_1d(response.phase.squeeze())) - w * values.delay_s
    return np.atleast_1d(response.magnitude.squeeze()), np.degrees(phase)


def poles(values: DriveValues) -> Complex:
    """Return the poles of G [rad/s], shape (order,)."""
    return np.asarray(transfer_function(values).poles(), dtype=np.complex128)


def tables(drive: DriveFile, title: str) -> Iterator[Table]:
    """Yield the tables of an identified drive; the title is that of the parameters."""
    structures = [
        (
            s.name,
            str(s.parameters),
            number_text(s.held_out_times_noise),
            "chosen" if s.chosen else "" if s.converged else "not converged",
        )
        for s in drive.structures
    ]
    header = ("structure", "parameters", "error", "")
    yield "structures of G(s), error on held-out data in times the noise", header, structures
    lead = drive.kinematics.kinematic_lead_rpm_s_per_mm
    rows = [(p.name, p.text(), p.unit) for p in drive.parameters]
    if lead is not None:
        rows.append(("60 im/(2π r1), kinematic", f"{lead:.5g}", "rpm s/mm"))
    yield title, ("name", "value [95 %]", "unit"), rows
    runs = [
        (
            name,
            number_text(run.rmse, ".4g"),
            number_text(run.rmse_nominal, ".4g"),
            number_text(run.noise, ".2g"),
        )
        for name, run in drive.runs.items()
    ]
    yield "x_in against measurement [mm]", ("run", "RMSE", "nominal", "noise"), runs
    named = [
        (
            cause.effect,
            name,
            value.text(),
            value.unit,
            number_text(cause.gain_percent, ".1f"),
            ", ".join(cause.rivals),
        )
        for cause in drive.diagnosis.named
        for name, value in cause.parameters.items()
    ]
    if named:
        yield (
            "causes",
            ("effect", "parameter", "value [95 %]", "unit", "reduction [%]", "rivals"),
            named,
        )
    yield errors_table(drive.diagnosis.channels)
