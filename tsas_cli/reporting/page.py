"""The page that a person reads: every section in order, in one file that needs nothing else."""

from collections.abc import Callable
from dataclasses import replace

from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting import prediction, repeat, simulation, summary
from tsas_cli.reporting.calibration import parameters, stiffness, transfer
from tsas_cli.reporting.closing import section as closing
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.diagnosis import section as diagnosis
from tsas_cli.reporting.drive import section as drive
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.recordings import loops
from tsas_cli.reporting.recordings import section as recordings
from tsas_cli.reporting.rendered import rendered
from tsas_cli.reporting.tracking import section as tracking

SECTIONS: tuple[Callable[[Inputs], Section | None], ...] = (
    closing.section,
    tracking.section,
    diagnosis.section,
    prediction.section,
    drive.section,
    recordings.section,
    stiffness.section,
    transfer.section,
    loops.section,
    simulation.section,
    parameters.section,
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
        summary=" ".join(summary.sentences(inputs)),
        sections=sections,
        glance=glance(inputs),
    )
