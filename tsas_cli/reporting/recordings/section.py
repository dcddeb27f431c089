"""What the recordings are, and what the checks say about them."""

from collections.abc import Sequence

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain

_SEVERITIES = ("error", "warning", "note")
_SHOWN = 4


def section(inputs: Inputs) -> Section | None:
    """Return the section of the recordings and the findings, None where there is no dataset."""
    if inputs.dataset is None:
        return None
    manifest = inputs.dataset.manifest
    kind = {"measured": "measured on a rig", "simulated": "simulated, not measured"}[manifest.kind]
    intro = [f"The dataset {manifest.name} holds {len(manifest.run)} recordings, {kind}."]
    intro += [text for text in (manifest.description, _credit(manifest)) if text]
    tables = [_runs(inputs.dataset)]
    if inputs.check.findings:
        tables.append(_findings(inputs.check))
    if inputs.check.not_checked:
        tables.append(_not_checked(inputs.check))
    return Section("recordings", "Recordings", tuple(intro), tables=tuple(tables))


def _credit(manifest: Manifest) -> str:
    parts = [("Source", manifest.source), ("License", manifest.license)]
    return " ".join(f"{name}: {text.rstrip('.')}." for name, text in parts if text)


def _runs(dataset: Dataset) -> Table:
    more = list(dict.fromkeys(key for run in dataset.manifest.run for key in run.model_extra or {}))
    header = (
        "run",
        "channels",
        "samples",
        "duration [s]",
        "rate [Hz]",
        "sheath length [mm]",
        "total bend [rad]",
        "preload [N]",
        *more,
        "started",
        "load",
    )
    rows = tuple(_run(recording, more) for recording in dataset)
    numeric = frozenset(range(2, 8 + len(more)))
    return Table("The recordings", header, rows, numeric=numeric).without_empty()


def _run(recording: Recording, more: Sequence[str]) -> tuple[str, ...]:
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
        *(str((run.model_extra or {}).get(key, ABSENT)) for key in more),
        run.started.isoformat(" ") if run.started else ABSENT,
        run.load,
    )


def _findings(check: CheckFile) -> Table:
    """Return the findings, errors first; of many of one kind the first few, and whose they are."""
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for finding in sorted(check.findings, key=_rank):
        kinds.setdefault((finding.severity, finding.code), []).append(finding)
    rows: list[tuple[str, ...]] = []
    for (severity, code), found in kinds.items():
        shown, rest = found[:_SHOWN], found[_SHOWN:]
        rows += [
            (severity, code, f.run or ABSENT, f.column or ABSENT, f.sentence, f.remedy)
            for f in shown
        ]
        if rest:
            runs = ", ".join(dict.fromkeys(f.run for f in rest if f.run)) or ABSENT
            more = f"{len(rest)} more of this kind; `tsas check` lists them"
            rows.append((severity, code, runs, ABSENT, more, ""))
    header = ("severity", "code", "run", "column", "what", "what to do")
    return Table("What the checks found", header, tuple(rows)).without_empty()


def _rank(finding: Finding) -> int:
    return _SEVERITIES.index(finding.severity) if finding.severity in _SEVERITIES else -1


def _not_checked(check: CheckFile) -> Table:
    reasons: dict[tuple[str, str], list[str]] = {}
    for silent in check.not_checked:
        reasons.setdefault((silent.code, silent.reason), []).append(silent.run or ABSENT)
    rows = tuple((code, reason, ", ".join(runs)) for (code, reason), runs in reasons.items())
    return Table("What the checks could not tell", ("code", "reason", "runs"), rows)
