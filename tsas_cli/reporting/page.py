"""The page that a person reads: every section in order, in one file that needs nothing else."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from tsas_cli.records.base import OfDataset
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting import (
    calibration,
    closing,
    drive,
    prediction,
    recordings,
    repeat,
    simulation,
)
from tsas_cli.reporting.content import Section, rendered
from tsas_cli.reporting.diagnosis import section as diagnosis
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.tracking import section as tracking
from tsas_cli.support.wording import count_of
from tsas_cli.verifying.claims import change_notes

SECTIONS: tuple[Callable[[Inputs], Section | None], ...] = (
    closing.section,
    tracking.section,
    diagnosis.section,
    prediction.section,
    drive.section,
    recordings.section,
    calibration.section,
    calibration.transfer_section,
    recordings.loops_section,
    simulation.section,
    calibration.parameters_section,
    repeat.section,
)


def page(inputs: Inputs, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each of `SECTIONS`.

    A page of a drive, of predictions, of tracked runs, or of what a better model is worth in
    tracking, leaves out what was not given; any other says what is missing.

    InputError: a recording or a simulated run cannot be read.
    """
    kinds = (ClosingFile, TrackingFile, DriveFile, PredictionFile)
    alone = any(inputs.get(kind) is not None for kind in kinds)
    sections: list[Section] = []
    for make in SECTIONS:
        section = make(inputs)
        if section is not None and (section.given or not alone):
            sections.append(replace(section, folded=bool(sections)))
        advance()
    name, about = "From diagnosis to tracking", "hidden differences, named and tracked"
    if inputs.dataset is not None:
        name, about = inputs.dataset.manifest.name, "recordings, model and residual"
    return rendered(
        name=name,
        about=about,
        summary=" ".join(_sentences(inputs)),
        sections=sections,
        glance=glance(inputs),
    )


def _sentences(inputs: Inputs) -> Iterator[str]:
    """Yield the sentences of the first paragraph; without a dataset, only what was changed."""
    yield from change_notes(folder for _, folder in inputs.given)
    if inputs.dataset is None:
        return
    manifest = inputs.dataset.manifest
    many = count_of(len(manifest.run), "recording")
    yield f"{manifest.name} holds {many}, {manifest.kind}."
    severities = [finding.severity for finding in inputs.check.findings]
    counts = {name: severities.count(name) for name in ("error", "warning", "note")}
    counted = ", ".join(count_of(n, name) for name, n in counts.items() if n)
    yield f"The checks {f'report {counted}: see Recordings' if counted else 'found nothing'}."
    of_data = [stage for stage, _ in inputs.given if isinstance(stage, OfDataset)]
    yield from dict.fromkeys(sentence for stage in of_data for sentence in stage.accepted())
    calibration = inputs.get(CalibrationFile)
    if calibration and calibration.cannot_tell and inputs.get(DiagnosisFile) is None:
        notes = calibration.cannot_tell
        yield f"Keep in mind: {notes[0]}"
        if notes[1:]:
            yield f"{count_of(len(notes) - 1, 'more note')} on the estimates: see Parameters."
