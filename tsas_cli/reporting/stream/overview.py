"""What the overview says beside the plots: what it is about and what came out, as Markdown."""

import re
from collections.abc import Iterator

from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.support.errors import printable

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>()#+\-!|~&$^])")


def overview(inputs: Inputs) -> str:
    """Return what the recordings are, the answer and its numbers, and what to keep in mind."""
    manifest = None if inputs.dataset is None else inputs.dataset.manifest
    title = "Recordings" if manifest is None else manifest.name
    about = "" if manifest is None else manifest.description
    said = (f"- {plain_text(point)}" for point in _points(inputs))
    lines = [f"# {plain_text(title)}", plain_text(about), *_first_screen(inputs), *said]
    return "\n\n".join(filter(None, lines))


def plain_text(text: str) -> str:
    """Return text of which no letter is read as Markdown or HTML."""
    return _SPECIAL.sub(r"\\\1", printable(text))


def _first_screen(inputs: Inputs) -> Iterator[str]:
    """Yield the first screen of the page."""
    first = glance(inputs)
    if first is None:
        return
    yield f"**{plain_text(first.kind)}: {plain_text(first.verdict)}**"
    yield plain_text(first.numbers)
    for fact in first.facts:
        number = " → ".join(filter(None, (fact.before, fact.value)))
        note = f" ({plain_text(fact.note)})" if fact.note else ""
        yield f"- {plain_text(f'{fact.label}: {number}')}{note}"


def _points(inputs: Inputs) -> Iterator[str]:
    if diagnosis := inputs.get(DiagnosisFile):
        yield from (diagnosis.reason, f"Next: {diagnosis.next_experiment}")
    if tracking := inputs.get(TrackingFile):
        yield from tracking.notes
    if simulation := inputs.get(SimulationFile):
        yield from simulation.notes
    if calibration := inputs.get(CalibrationFile):
        yield from calibration.cannot_tell
    if check := inputs.get(CheckFile):
        for found in check.findings:
            where = f"run {found.run}, " if found.run else ""
            yield f"{found.severity}, {where}{found.code}: {found.sentence}"
