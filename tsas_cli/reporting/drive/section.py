"""The drive: its transfer function, the structures that were tried, and what Eq. (25) lacks."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from tsas_cli.drive.tables import tables
from tsas_cli.records.drive import DriveFile, FrequencyResponses, Pole
from tsas_cli.reporting.content import Picture, Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.drive.figures import draw_bode, draw_poles
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain, spanned
from tsas_cli.reporting.two_residuals import Residuals, draw_two_residuals, height_in


def section(inputs: Inputs) -> Section | None:
    """Return the section of the drive, None without one; its first sentence is the verdict."""
    drive = inputs.get(DriveFile)
    if drive is None:
        return None
    printed = tuple(map(Table.printed, tables(drive, "The identified drive")))
    evidence = (drive.diagnosis.evidence.sentence, f"Next: {drive.diagnosis.next_experiment}")
    parts = (
        Section("drive-numbers", "What was found, in numbers", tables=printed),
        Section("drive-response", "Frequency response and poles", pictures=_response(drive)),
        Section("drive-left", "What is left", pictures=_residuals(inputs, drive)),
        Section("drive-next", "Evidence and next experiment", evidence),
    )
    return Section(
        "drive",
        "Drive",
        tuple(_intro(drive)),
        points=drive.cannot_tell,
        equations=(drive.structure.equation, drive.inverse),
        parts=parts,
    )


def _intro(drive: DriveFile) -> Iterator[str]:
    lead = drive.kinematics
    yield drive.diagnosis.reason
    if lead.kinematic_lead_rpm_s_per_mm is not None:
        yield (
            f"At low speed the motor's speed leads x_in by {plain(lead.fitted_lead_rpm_s_per_mm)} "
            f"rpm s/mm; kinematics alone, 60 im/(2π r1), make it "
            f"{plain(lead.kinematic_lead_rpm_s_per_mm)}."
        )
    if not drive.fit.converged:
        yield f"The fit did not converge: {drive.fit.message}"


def _response(drive: DriveFile) -> tuple[Picture, ...]:
    response = drive.frequency_response
    band = response.band_Hz
    shown = (
        "" if band is None else f" The input shows {plain(band[0], 3)} to {plain(band[1], 3)} Hz."
    )
    bode = picture(
        partial(draw_bode, measured=response.measured, fitted=response.fitted, band_Hz=band),
        key="drive-bode",
        alt=f"From motor speed to x_in over frequency.{shown} {_bode_in_words(response)}",
        caption=f"From motor speed to x_in: measured where the coherence tells, and fitted.{shown}",
        height_in=5.0,
    )
    poles = picture(
        partial(draw_poles, poles=drive.poles, band_Hz=band),
        key="drive-poles",
        alt=f"Poles of the fitted transfer function in the complex plane: one at 0"
        f"{''.join(map(_pole_in_words, drive.poles))}.",
        caption="Poles of G(s), the integrator's at 0; between the dashed lines the input shows "
        "them. A diamond is 1/delay.",
        height_in=4.0,
    )
    return bode, poles


def _bode_in_words(response: FrequencyResponses) -> str:
    fitted = response.fitted
    at = np.array(fitted.frequency_Hz)
    if not at.size:
        return ""
    chosen = sorted({0, at.size // 2, at.size - 1})
    said = "; ".join(
        f"{plain(at[k], 3)} Hz {plain(fitted.magnitude[k], 3)} mm/(rpm s) at "
        f"{plain(fitted.phase_deg[k], 3)}°"
        for k in chosen
    )
    excited = sum(response.measured.excited)
    return f"Fitted magnitude and phase: {said}. Measured at {excited} frequencies with coherence."


def _pole_in_words(pole: Pole) -> str:
    where = "" if pole.in_band else ", outside of what the input shows"
    return f"; {pole.kind} at {plain(pole.frequency_Hz, 3)} Hz{where}"


def _residuals(inputs: Inputs, drive: DriveFile) -> tuple[Picture, ...]:
    panels, said = [], []
    for recording in inputs.recordings:
        run, x_in = drive.runs.get(recording.run.id), recording.get("x_in_mm")
        if run is None or x_in is None or run.noise is None:
            continue
        nominal, fitted = (
            x_in - inputs.series(recording.run.id, x_in.size, column, DriveFile)
            for column in ("x_in_nominal_mm", "x_in_mm")
        )
        label = f"{recording.run.id} [mm]"
        panels.append(Residuals(label, recording.time_s, nominal, fitted, run.noise))
        said.append(
            f"run {recording.run.id}: nominal {spanned(nominal)}, identified {spanned(fitted)}, "
            f"noise {plain(run.noise, 3)}"
        )
    if not panels:
        return ()
    shown = picture(
        partial(draw_two_residuals, panels=panels, names=("nominal", "identified")),
        key="drive-residuals",
        alt=f"Measured less simulated x_in over time, in millimetre: {'; '.join(said)}.",
        caption="Measured less simulated x_in; noise alone leaves 95 % between the dashed lines.",
        height_in=height_in(len(panels)),
    )
    return (shown,)
