"""The drive: its transfer function, the structures that were tried, and what Eq. (25) lacks."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from tsas_cli.records.drive import DriveFile, FrequencyResponses, Pole
from tsas_cli.reporting.content import Picture, Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.drive.figures import draw_bode, draw_poles, draw_residuals
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain, spanned, with_interval

_TITLE = "Drive"


def section(inputs: Inputs) -> Section | None:
    """Return the section of the drive, None without one; its first sentence is the verdict."""
    drive = inputs.get(DriveFile)
    if drive is None:
        return None
    return drive_section(drive, _response(drive), _residuals(inputs, drive))


def drive_section(
    drive: DriveFile, response: tuple[Picture, ...] = (), left: tuple[Picture, ...] = ()
) -> Section:
    """Return the section with pictures of the frequency response and of what is left, if any."""
    lead = drive.kinematics
    intro = [drive.diagnosis.reason]
    if lead.kinematic_lead_rpm_s_per_mm is not None:
        intro.append(
            f"At low speed the motor's speed leads x_in by {plain(lead.fitted_lead_rpm_s_per_mm)} "
            f"rpm s/mm; kinematics alone, 60 im/(2π r1), make it "
            f"{plain(lead.kinematic_lead_rpm_s_per_mm)}."
        )
    if not drive.fit.converged:
        intro.append(f"The fit did not converge: {drive.fit.message}")
    return Section(
        "drive",
        _TITLE,
        tuple(intro),
        points=drive.cannot_tell,
        equations=(drive.structure.equation, drive.inverse),
        parts=tuple(_parts(drive, response, left)),
    )


def _parts(
    drive: DriveFile, response: tuple[Picture, ...], left: tuple[Picture, ...]
) -> Iterator[Section]:
    lacks = tuple(_causes(drive))
    if lacks:
        yield Section("drive-causes", "What the nominal drive lacks", tables=lacks)
    yield Section("drive-parameters", "The identified drive", tables=(_parameters(drive),))
    if response:
        yield Section("drive-response", "Frequency response and poles", pictures=response)
    yield Section("drive-left", "What is left", tables=(_errors(drive),), pictures=left)
    if drive.structures:
        yield Section("drive-structures", "Structures tried", tables=(_structures(drive),))
    yield Section(
        "drive-next",
        "Evidence and next experiment",
        tuple(text for text in (drive.diagnosis.evidence.sentence, _next(drive)) if text),
    )


def _next(drive: DriveFile) -> str:
    following = drive.diagnosis.next_experiment
    return f"Next: {following}" if following else ""


def _parameters(drive: DriveFile) -> Table:
    rows = tuple(
        (
            p.name,
            *with_interval(p.value, p.interval_low, p.interval_high),
            p.unit,
            p.origin,
            "yes" if p.at_bound else "no",
        )
        for p in drive.parameters
    )
    header = ("parameter", "value", "95 % interval", "unit", "origin", "at its bound")
    return Table("Parameters of the drive", header, rows, numeric=frozenset({1, 2}))


def _causes(drive: DriveFile) -> Iterator[Table]:
    rows = tuple(
        (
            cause.effect,
            name,
            *with_interval(p.value, p.interval_low, p.interval_high),
            p.unit,
            "yes" if p.at_bound else "no",
            plain(cause.gain_percent, 3),
            ", ".join(cause.rivals),
        )
        for cause in drive.diagnosis.named
        for name, p in cause.parameters.items()
    )
    header = (
        "effect",
        "parameter",
        "value",
        "95 % interval",
        "unit",
        "at its bound",
        "gain [%]",
        "rivals",
    )
    if rows:
        caption = "What the nominal drive lacks, and what each takes off the error on held-out data"
        yield Table(caption, header, rows, numeric=frozenset({2, 3, 6})).without_empty()


def _structures(drive: DriveFile) -> Table:
    rows = tuple(
        (
            s.name,
            str(s.parameters),
            plain(s.held_out_times_noise, 3),
            "chosen" if s.chosen else "" if s.converged else "not converged",
        )
        for s in drive.structures
    )
    header = ("structure of G(s)", "parameters", "error / noise", "remark")
    caption = "Structures and their error on held-out data; the simplest one not surely worse"
    return Table(caption, header, rows, numeric=frozenset({1, 2}))


def _errors(drive: DriveFile) -> Table:
    rows = tuple(
        (name, plain(run.rmse_nominal, 3), plain(run.rmse, 3), plain(run.noise, 3))
        for name, run in drive.runs.items()
    )
    header = ("run", "RMSE, nominal", "RMSE, identified", "noise")
    return Table("Simulated against measured x_in [mm]", header, rows, numeric=frozenset({1, 2, 3}))


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
    runs, said = {}, []
    for recording in inputs.recordings:
        run, x_in = drive.runs.get(recording.run.id), recording.get("x_in_mm")
        if run is None or x_in is None or run.noise is None:
            continue
        nominal, fitted = (
            x_in - inputs.series(recording.run.id, x_in.size, column, DriveFile)
            for column in ("x_in_nominal_mm", "x_in_mm")
        )
        runs[recording.run.id] = (recording.time_s, nominal, fitted, run.noise)
        said.append(
            f"run {recording.run.id}: nominal {spanned(nominal)}, identified {spanned(fitted)}, "
            f"noise {plain(run.noise, 3)}"
        )
    if not runs:
        return ()
    shown = picture(
        partial(draw_residuals, runs=runs),
        key="drive-residuals",
        alt=f"Measured less simulated x_in over time, in millimetre: {'; '.join(said)}.",
        caption="Measured less simulated x_in; noise alone leaves 95 % between the dashed lines.",
        height_in=0.6 + 1.5 * len(runs),
    )
    return (shown,)
