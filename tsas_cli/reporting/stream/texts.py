"""What is said beside what is seen: in short for the overview, and the diagnosis in full."""

from collections.abc import Iterator

from tsas_cli.identification.model import read_model
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.base import Value, parameters_of
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.calibration import parameters
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.diagnosis import candidates, causes, gains
from tsas_cli.reporting.diagnosis.section import remainder
from tsas_cli.reporting.drive.section import drive_section
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain, with_interval
from tsas_cli.reporting.stream.markdown import section_text
from tsas_cli.reporting.tracking.scores import best_and_worst

_NARROW = ("parameter", "value", "95 % interval", "unit")


def overview(inputs: Inputs) -> str:
    """Return what it is about and what came out, as Markdown."""
    manifest = None if inputs.dataset is None else inputs.dataset.manifest
    title = "Recordings" if manifest is None else manifest.name
    about = () if manifest is None or not manifest.description else (manifest.description,)
    return section_text(Section("overview", title, about, parts=tuple(_short(inputs))))


def diagnosis(inputs: Inputs) -> str | None:
    """Return the diagnosis of the tendon or the drive with its tables, None without one.

    Raises
    ------
    InputError
        The extended model cannot be read.
    """
    found, drive = inputs.get(DiagnosisFile), inputs.get(DriveFile)
    if found is not None:
        parts = (
            *causes.parts(found),
            Section("gains", "What it is worth", tables=(gains.table(found),)),
            candidates.part(found),
            *remainder(found),
            _extended(inputs),
        )
        found_parts = tuple(part for part in parts if part is not None)
        return section_text(Section("diagnosis", "Diagnosis", (found.reason,), parts=found_parts))
    return None if drive is None else section_text(drive_section(drive))


def _short(inputs: Inputs) -> Iterator[Section]:
    """Yield what each stage says in few words and narrow tables."""
    if found := inputs.get(DiagnosisFile):
        named = tuple(_narrow(p, n) for cause in found.named for n, p in cause.parameters.items())
        both = Table("What is named", _NARROW, named, numeric=frozenset({1, 2})), _held_out(found)
        tables = tuple(table for table in both if table.rows)
        after = (f"Next: {found.next_experiment}",) if found.next_experiment else ()
        yield Section("diagnosis", "Diagnosis", (found.reason,), tables=tables, closing=after)
    if tracking := inputs.get(TrackingFile):
        said = tuple(best_and_worst(tracking))
        table = _scores(tracking)
        yield Section("tracking", "Tracking", said, points=tracking.notes, tables=(table,))
    if drive := inputs.get(DriveFile):
        section = drive_section(drive)
        yield Section("drive", "Drive", section.intro, equations=section.equations)
    if simulation := inputs.get(SimulationFile):
        table = _errors(simulation)
        yield Section("simulation", "Simulation", points=simulation.notes, tables=(table,))
    if calibration := inputs.get(CalibrationFile):
        rows = tuple(
            _narrow(p, p.name if p.run is None else f"{p.name}, run {p.run}")
            for p in calibration.parameters
        )
        table, said = Table("Parameters", _NARROW, rows), calibration.cannot_tell
        yield Section("calibration", "Calibration", points=said, tables=(table,))
    if check := inputs.get(CheckFile):
        found_out = tuple(_finding(finding) for finding in check.findings)
        said = () if found_out else ("The checks found nothing.",)
        yield Section("check", "Checks", said, points=found_out)


def _finding(finding: Finding) -> str:
    where = f"run {finding.run}, " if finding.run else ""
    return f"{finding.severity}, {where}{finding.code}: {finding.sentence}"


def _narrow(p: Value, name: str) -> tuple[str, ...]:
    unit = p.unit + (", at its bound" if p.at_bound else "")
    return (name, *with_interval(p.value, p.interval_low, p.interval_high), unit)


def _held_out(found: DiagnosisFile) -> Table:
    rows = tuple(
        (name, plain(c.rmse_before, 3), plain(c.rmse_after, 3), plain(c.noise_floor, 3), c.unit)
        for name, c in found.channels.items()
    )
    header = ("channel", "before", "after", "noise", "unit")
    return Table("Error on held-out data", header, rows, numeric=frozenset({1, 2, 3}))


def _scores(tracking: TrackingFile) -> Table:
    rows = tuple(
        (result.controller, result.condition, plain(result.scores.rmse_N.mean))
        for result in tracking.results
    )
    return Table("How well it is followed", ("controller", "condition", "RMSE [N]"), rows)


def _errors(simulation: SimulationFile) -> Table:
    rows = tuple(
        (run_id, name, plain(channel.rmse, 3), plain(channel.noise, 3))
        for run_id, run in simulation.runs.items()
        for name, channel in run.channels.items()
    )
    header = ("run", "channel", "RMSE", "noise")
    return Table("Simulated against measured", header, rows, numeric=frozenset({2, 3}))


def _extended(inputs: Inputs) -> Section:
    model = read_model(inputs.folders[DiagnosisFile] / EXTENDED_MODEL)
    table = parameters.table(f"Parameters of {EXTENDED_MODEL}", parameters_of(model.estimates))
    return Section("model", "The model with what is named", tables=(table,))
