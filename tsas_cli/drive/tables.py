"""What `tsas identify-harmonic-drive` prints."""

from collections.abc import Iterator

from tsas_cli.records.base import number_text
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.result import Table


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
    errors = [
        (
            name,
            *map(number_text, (c.rmse_before, c.rmse_after, c.noise_floor, c.attainable)),
            c.unit,
        )
        for name, c in drive.diagnosis.channels.items()
    ]
    columns = ("channel", "before", "after", "noise", "attainable", "unit")
    yield "error on held-out data", columns, errors
