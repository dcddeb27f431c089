"""The drive: its transfer function, the structures that were tried, and what Eq. (25) lacks."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from tsas_cli.drive.json import tables
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.records.drive import DriveFile, FrequencyResponses
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section, table_of
from tsas_cli.reporting.drawing import Residuals, bound, legend, picture, two_residuals
from tsas_cli.reporting.inputs import Inputs, series_of
from tsas_cli.reporting.names import X_IN
from tsas_cli.reporting.numbers import RAISED, plain, spanned


def section(inputs: Inputs) -> Section | None:
    """Return the section of the drive, None without one; its first sentence is the verdict."""
    drive = inputs.get(DriveFile)
    if drive is None:
        return None
    structures, identified, *more = (table_of(*it) for it in tables(drive, "The identified drive"))
    evidence, tried = (drive.diagnosis.evidence.sentence,), (structures, *more)
    parts = (
        Section("drive-response", "Frequency response and poles", pictures=_response(drive)),
        Section("drive-left", "What is left", pictures=tuple(_residuals(inputs, drive))),
        Section("drive-tried", "What was tried", evidence, tables=tried, folded=True),
    )
    return Section(
        "drive",
        "Drive",
        tuple(_intro(drive)),
        points=drive.cannot_tell,
        equations=(drive.structure.equation, drive.inverse),
        tables=(identified,),
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
    measured, fitted = response.measured, response.fitted

    def draw_bode(figure: Any) -> None:
        """Draw magnitude, phase and coherence; measured dots where the input excites the drive."""
        rows = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1.5))
        at, excited = np.array(measured.frequency_Hz), np.array(measured.excited, dtype=bool)
        dots = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.0, "markersize": 3.2}
        for axes, seen, curve in (
            (rows[0], measured.magnitude, fitted.magnitude),
            (rows[1], measured.phase_deg, fitted.phase_deg),
        ):
            style = {"color": STAND_IN["measured"], "label": "measured", **dots}
            axes.plot(at[excited], np.array(seen)[excited], **style)
            axes.plot(fitted.frequency_Hz, curve, color=STAND_IN["simulated"], label="fitted")
        rows[0].set(xscale="log", yscale="log", ylabel="|G| [mm/(rpm s)]")
        rows[1].set_ylabel("phase [°]")
        rows[2].plot(at, measured.coherence, color=STAND_IN["muted"], linewidth=0.9)
        bound(rows[2], 0.8)
        rows[2].set(ylim=(0.0, 1.05), ylabel="coherence", xlabel="frequency [Hz]")
        if band is not None:
            for axes in rows:
                axes.axvspan(*band, color=STAND_IN["line"], alpha=0.5, linewidth=0.0, zorder=0)
                for edge in band:
                    axes.axvline(edge, color=STAND_IN["muted"], linewidth=0.5, zorder=0)
        rows[0].set_xlim(at[0], at[-1])
        # The page's text is no mathematics: powers of ten are written out.
        rows[0].yaxis.set_major_formatter(_power)
        rows[2].xaxis.set_major_formatter("{x:g}")
        rows[2].xaxis.set_minor_formatter("")
        figure.align_ylabels()
        legend(figure, rows[0])

    bode = picture(
        draw_bode,
        key="drive-bode",
        alt=f"From motor speed to x_in over frequency.{shown} {_bode_in_words(response)}",
        caption=f"From motor speed to x_in: measured where the coherence tells, and fitted.{shown}",
        height_in=5.0,
    )
    places = "".join(
        f"; {pole.kind} at {plain(pole.frequency_Hz, 3)} Hz"
        + ("" if pole.in_band else ", outside of what the input shows")
        for pole in drive.poles
    )

    def draw_poles(figure: Any) -> None:
        """Draw the poles in the complex plane, coloured by whether they are in the input's band."""
        axes = figure.subplots()
        look = {"linestyle": "none", "markersize": 8, "markeredgewidth": 1.8}
        for pole in drive.poles:
            y = pole.imaginary_per_s / (2.0 * math.pi)
            look["marker"] = "x" if pole.kind == "pole" else "D"
            look["color"] = STAND_IN["after" if pole.in_band else "before"]
            for place in dict.fromkeys((y, -y)):
                axes.plot(pole.real_per_s, place, markerfacecolor="none", **look)
        axes.plot(0.0, 0.0, **look | {"marker": "x", "color": STAND_IN["ink"]})
        angle = np.linspace(0.5 * math.pi, 1.5 * math.pi, 100)
        dashed = {"color": STAND_IN["muted"], "linewidth": 1.0, "linestyle": (0, (4, 3))}
        for edge in band or ():
            axes.plot(2.0 * math.pi * edge * np.cos(angle), edge * np.sin(angle), **dashed)
        axes.axvline(0.0, color=STAND_IN["muted"], linewidth=0.8)
        axes.set(xlabel="real part [1/s]", ylabel="imaginary part [Hz]")

    diamond = " A diamond is 1/delay." if any(p.kind != "pole" for p in drive.poles) else ""
    poles = picture(
        draw_poles,
        key="drive-poles",
        alt=f"Poles of the fitted transfer function in the complex plane: one at 0{places}.",
        caption="Poles of G(s), the integrator's at 0; between the dashed lines the input shows "
        f"them.{diamond}",
        height_in=4.0,
    )
    return bode, poles


def _bode_in_words(response: FrequencyResponses) -> str:
    fitted = response.fitted
    at = np.array(fitted.frequency_Hz)
    if not at.size:
        return ""
    chosen = sorted({0, at.size // 2, at.size - 1})
    points = "; ".join(
        f"{plain(at[k], 3)} Hz {plain(fitted.magnitude[k], 3)} mm/(rpm s) at "
        f"{plain(fitted.phase_deg[k], 3)}°"
        for k in chosen
    )
    excited = sum(response.measured.excited)
    return (
        f"Fitted magnitude and phase: {points}. Measured at {excited} frequencies with coherence."
    )


def _residuals(inputs: Inputs, drive: DriveFile) -> Iterator[Picture]:
    """Yield the picture of the residuals of x_in, a panel for each run."""
    panels, ranges = [], []
    for recording in inputs.recordings:
        run, x_in = drive.runs.get(recording.run.id), recording.get(X_IN)
        if run is None or x_in is None or run.noise is None:
            continue
        nominal, fitted = (
            x_in - series_of(inputs.folders[DriveFile], recording.run.id, x_in.size, column)
            for column in (nominal_name(X_IN), X_IN)
        )
        label = f"{recording.run.id} [mm]"
        panels.append(Residuals(label, recording.time_s, nominal, fitted, run.noise))
        ranges.append(
            f"run {recording.run.id}: nominal {spanned(nominal)}, identified {spanned(fitted)}, "
            f"noise {plain(run.noise, 3)}"
        )
    if panels:
        yield two_residuals(
            panels,
            names=("nominal", "identified"),
            key="drive-residuals",
            alt=f"Measured less simulated x_in over time, in millimetre: {'; '.join(ranges)}.",
            caption="Measured less simulated x_in; noise alone leaves 95 % between the dashed "
            "lines.",
        )


def _power(value: float, _: object) -> str:
    return "10" + str(round(math.log10(value))).translate(RAISED) if value > 0.0 else ""
