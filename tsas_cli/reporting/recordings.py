"""What the recordings are, what the checks say about them, and their loops by phase."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import (
    MOST_RUNS,
    Picture,
    Section,
    Table,
    pictures_by_run,
    table_by_column,
    table_of,
)
from tsas_cli.reporting.drawing import kept_samples, legend, picture, shared_points
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import (
    PHASES,
    TENSIONS,
    X_IN,
    at_axis,
    in_words,
    label_of,
    phase_of_samples,
    role_of_phase,
)
from tsas_cli.reporting.numbers import ABSENT, plain, spanned
from tsas_cli.support.arrays import Floats, Mask

_POINTS = 20_000  # of all loops
Keys = npt.NDArray[np.object_]
_SEVERITIES = ("error", "warning", "note")
_SHOWN = 4


def section(inputs: Inputs) -> Section | None:
    """Return the section of the recordings and the findings, None where there is no dataset."""
    if inputs.dataset is None:
        return None
    manifest = inputs.dataset.manifest
    kind = {"measured": "measured on a rig", "simulated": "simulated, not measured"}[manifest.kind]
    intro = [f"The dataset {manifest.name} holds {len(manifest.run)} recordings, {kind}."]
    credit = [("Source", manifest.source), ("License", manifest.license)]
    origin = " ".join(f"{name}: {text.rstrip('.')}." for name, text in credit if text)
    intro += [text for text in (manifest.description, origin) if text]
    tables = [table_by_column("The recordings", map(_run, inputs.dataset))]
    if inputs.check.findings:
        tables.append(_findings(inputs.check))
    if reasons := inputs.check.reasons():
        header = ("code", "reason", "runs")
        tables.append(table_of("What the checks could not tell", header, reasons))
    return Section("recordings", "Recordings", tuple(intro), tables=tuple(tables))


def _run(recording: Recording) -> dict[str, str]:
    """Return what a recording is, by column of the table."""
    run, time_s = recording.run, recording.time_s
    duration = float(time_s[-1] - time_s[0])
    channels = [name for name in BY_NAME if name in recording.columns and name != TIME]
    row = {
        "run": run.id,
        "channels": ", ".join(channels),
        "samples": str(time_s.size),
        "duration [s]": plain(duration),
        "rate [Hz]": plain((time_s.size - 1) / duration),
        "sheath length [mm]": plain(run.sheath_length_mm),
        "total bend [rad]": plain(run.total_bend_rad),
        "preload [N]": plain(run.preload_N),
    }
    more = {key: str(value) for key, value in (run.model_extra or {}).items() if key not in row}
    started = run.started.isoformat(" ") if run.started else ABSENT
    return row | more | {"started": started, "load": run.load}


def _findings(check: CheckFile) -> Table:
    """Return the findings, errors first; of many of one kind the first few, and whose they are."""
    kinds: dict[tuple[str, str], list[Finding]] = {}
    rank = {severity: place for place, severity in enumerate(_SEVERITIES)}
    for finding in sorted(check.findings, key=lambda finding: rank.get(finding.severity, -1)):
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
    return table_of("What the checks found", header, rows)


def loops_section(inputs: Inputs) -> Section | None:
    """Return the section of the loops, one group per run, None where there is no dataset."""
    if inputs.dataset is None:
        return None
    intro = "Each cycle runs through four phases, numbered in the order in which they follow."
    calibration = inputs.get(CalibrationFile)
    if calibration is None:
        intro = "Without a folder written by `tsas calibrate`, the phases are unknown."
    segments = calibration.segments if calibration else {}
    runs = len(inputs.dataset.runs)
    points = shared_points(len(TENSIONS) * min(runs, MOST_RUNS), _POINTS)
    groups, left = pictures_by_run(
        runs,
        (
            (one.run.id, _pictures(one, segments.get(one.run.id, ()), number, points))
            for number, one in enumerate(inputs.recordings)
        ),
    )
    if not groups:
        intro = "No run holds x_in_mm and a tension: there is no loop to show."
    return Section("loops", "Loops and phases", (intro, *left), groups=groups, given=bool(groups))


def _pictures(
    recording: Recording, segments: tuple[PhaseSegment, ...], number: int, points: int
) -> Iterator[Picture]:
    phase = phase_of_samples(recording.time_s, segments)
    x = recording.get(X_IN)
    for column in TENSIONS:
        y = recording.get(column)
        if x is None or y is None or not np.isfinite(x + y).any():
            continue
        whole = f"{at_axis(column)} {spanned(y)} over {at_axis(X_IN)} {spanned(x)}"
        shown = [key for key in PHASES if PHASES[key] and np.isfinite(y[phase == key]).any()]
        each = "; ".join(f"{label_of(key)} {spanned(y[phase == key])}" for key in shown)
        yield picture(
            partial(_draw_loop, x=x, y=y, phase=phase, column=column, points=points),
            key=f"loop-{number}-{column}",
            alt=f"Loop of run {recording.run.id}: {whole}. By phase: {each or 'unknown'}.",
            caption=f"{in_words(column).capitalize()} over {in_words(X_IN)}.",
        )


def _draw_loop(figure: Any, *, x: Floats, y: Floats, phase: Keys, column: str, points: int) -> None:
    """Draw a tension over x_in, shape (n,) each, NaN for gaps, in the colours of the phases."""
    axes = figure.add_subplot()
    y = np.where(np.isfinite(x), y, np.nan)
    kept = kept_samples(x, y, points=points)
    for key, number in PHASES.items():
        inside, colour = phase == key, STAND_IN[role_of_phase(key)]
        if inside.any():
            joined = inside[kept]
            joined[1:] |= joined[:-1].copy()  # up to the first sample of the next phase: no hole
            style = {"color": colour, "label": f"{number} {label_of(key)}".strip()}
            axes.plot(x[kept], np.where(joined, y[kept], np.nan), **style)
            _number(axes, x, y, inside, number, colour)
    axes.set(xlabel=at_axis(X_IN), ylabel=at_axis(column))
    if (phase != "unknown").any():
        legend(figure)


def _number(axes: Any, x: Floats, y: Floats, inside: Mask, number: str, colour: str) -> None:
    """Put the phase's number on its longest stretch, apart from that of the opposite phase."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(int)))
    first, after = max(edges.reshape(-1, 2), key=lambda stretch: stretch[1] - stretch[0])
    values = y[first:after]
    if not number or not np.isfinite(values).any():
        return
    height = 0.6 if number in "12" else 0.4
    level = height * np.nanmax(values) + (1 - height) * np.nanmin(values)
    at = first + int(np.nanargmin(np.abs(values - level)))
    axes.text(
        x[at],
        y[at],
        number,
        color=colour,
        ha="center",
        va="center",
        fontsize=8.5,
        fontweight="bold",
        clip_on=True,
        bbox={
            "boxstyle": "circle,pad=0.25",
            "facecolor": STAND_IN["paper"],
            "edgecolor": colour,
        },
    )
