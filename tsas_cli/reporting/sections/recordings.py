"""What the recordings are, and what the checks say about them."""

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.dataset import Recording
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain
from tsas_cli.reporting.stage_files import Check

_SEVERITIES = ("error", "warning", "note")


def section(inputs: Inputs) -> Section:
    """Return the section of the recordings and the findings about them."""
    manifest = inputs.dataset.manifest
    kind = {"measured": "measured on a rig", "simulated": "simulated, not measured"}[manifest.kind]
    intro = [f"The dataset {manifest.name} holds {len(manifest.run)} recordings, {kind}."]
    intro += [text for text in (manifest.description, _credit(inputs)) if text]
    tables = [_runs(inputs)]
    if inputs.check.findings:
        tables.append(_findings(inputs.check))
    if inputs.check.not_checked:
        tables.append(_not_checked(inputs.check))
    return Section("recordings", "Recordings", tuple(intro), tables=tuple(tables))


def _credit(inputs: Inputs) -> str:
    manifest = inputs.dataset.manifest
    parts = [("Source", manifest.source), ("License", manifest.license)]
    return " ".join(f"{name}: {text.rstrip('.')}." for name, text in parts if text)


def _runs(inputs: Inputs) -> Table:
    header = (
        "run",
        "channels",
        "samples",
        "duration [s]",
        "rate [Hz]",
        "sheath length [mm]",
        "total bend [rad]",
        "preload [N]",
        "load",
    )
    rows = tuple(_run(recording) for recording in inputs.dataset)
    return Table("The recordings", header, rows, numeric=frozenset(range(2, 8))).without_empty()


def _run(recording: Recording) -> tuple[str, ...]:
    run, time_s = recording.run, recording.time_s
    duration = float(time_s[-1] - time_s[0])
    return (
        run.id,
        ", ".join(name for name in BY_NAME if name in recording.columns and name != TIME),
        str(time_s.size),
        plain(duration),
        plain((time_s.size - 1) / duration),
        plain(run.sheath_length_mm),
        plain(run.total_bend_rad),
        plain(run.preload_N),
        run.load,
    )


def _findings(check: Check) -> Table:
    known = [f for severity in _SEVERITIES for f in check.findings if f.severity == severity]
    rows = tuple(
        (f.severity, f.run or ABSENT, f.column or ABSENT, f.sentence, f.remedy, f.code)
        for f in [*known, *(f for f in check.findings if f.severity not in _SEVERITIES)]
    )
    header = ("severity", "run", "column", "what", "what to do", "code")
    return Table("What the checks found", header, rows).without_empty()


def _not_checked(check: Check) -> Table:
    reasons: dict[tuple[str, str], list[str]] = {}
    for silent in check.not_checked:
        reasons.setdefault((silent.code, silent.reason), []).append(silent.run or ABSENT)
    rows = tuple((code, reason, ", ".join(runs)) for (code, reason), runs in reasons.items())
    return Table("What the checks could not tell", ("code", "reason", "runs"), rows)
