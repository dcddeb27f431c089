"""The drive: its transfer function, the structures that were tried, and what Eq. (25) lacks."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from tsas_cli.reporting.content import Picture, Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.drive_file import Drive
from tsas_cli.reporting.figures.drive import draw_bode, draw_poles, draw_residuals
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain, with_interval

_TITLE = "Drive"


def section(inputs: Inputs) -> Section | None:
    """Return the section of the drive, None without one; its first sentence is the verdict."""
    drive = inputs.get(Drive)
    if drive is None:
        return None
    return replace(told_of(drive), pictures=tuple(_pictures(inputs, drive)))


def told_of(drive: Drive) -> Section:
    """Return the section without its pictures."""
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
        tables=(_parameters(drive), *_causes(drive), _structures(drive), _errors(drive)),
        closing=(drive.diagnosis.evidence.sentence, f"Next: {drive.diagnosis.next_experiment}"),
    )


def _parameters(drive: Drive) -> Table:
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
    return Table("The identified drive", header, rows, numeric=frozenset({1, 2}))


def _causes(drive: Drive) -> Iterator[Table]:
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


def _structures(drive: Drive) -> Table:
    rows = tuple(
        (
            s.name,
            str(s.parameters),
            plain(s.held_out_times_noise, 3),
            "chosen" if s.chosen else "" if s.converged else "not converged",
        )
        for s in drive.structures
    )
    header = ("structure of G(s)", "parameters", "error / noise", "")
    caption = "Structures and their error on held-out data; the simplest one not surely worse"
    return Table(caption, header, rows, numeric=frozenset({1, 2}))


def _errors(drive: Drive) -> Table:
    rows = tuple(
        (name, plain(run.rmse_nominal, 3), plain(run.rmse, 3), plain(run.noise, 3))
        for name, run in drive.runs.items()
    )
    header = ("run", "RMSE, nominal", "RMSE, identified", "noise")
    return Table("Simulated against measured x_in [mm]", header, rows, numeric=frozenset({1, 2, 3}))


def _pictures(inputs: Inputs, drive: Drive) -> Iterator[Picture]:
    response = drive.frequency_response
    band = response.band_Hz
    shown = (
        "" if band is None else f" The input shows {plain(band[0], 3)} to {plain(band[1], 3)} Hz."
    )
    yield picture(
        partial(draw_bode, measured=response.measured, fitted=response.fitted, band_Hz=band),
        key="drive-bode",
        alt=f"Magnitude, phase and coherence of x_in over motor speed, measured and fitted.{shown}",
        caption=f"From motor speed to x_in: measured where the coherence tells, and fitted.{shown}",
        height_in=5.2,
    )
    yield picture(
        partial(draw_poles, poles=drive.poles, band_Hz=band),
        key="drive-poles",
        alt="Poles of the fitted transfer function in the complex plane, "
        + ", ".join(f"{plain(p.frequency_Hz, 3)} Hz" for p in drive.poles),
        caption="Poles of G(s), the integrator's at 0; between the dashed lines the input shows "
        "them. A diamond is 1/delay.",
        height_in=4.0,
    )
    runs = {}
    for recording in inputs.recordings:
        run, x_in = drive.runs.get(recording.run.id), recording.get("x_in_mm")
        if run is None or x_in is None or run.noise is None:
            continue
        nominal, fitted = (
            x_in - inputs.simulated(recording, column, Drive)
            for column in ("x_in_nominal_mm", "x_in_mm")
        )
        runs[recording.run.id] = (recording.time_s, nominal, fitted, run.noise)
    yield picture(
        partial(draw_residuals, runs=runs),
        key="drive-residuals",
        alt=f"Measured less simulated x_in over time, nominal and identified, of {len(runs)} runs",
        caption="Measured less simulated x_in; noise alone leaves 95 % between the dashed lines.",
        height_in=0.6 + 1.5 * max(len(runs), 1),
    )
