"""The page that a person reads: every section in order, in one file that needs nothing else."""

from collections.abc import Callable

from tsas_cli.reporting.content import Section
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.rendered import rendered
from tsas_cli.reporting.sections import (
    diagnosis,
    loops,
    parameters,
    recordings,
    repeat,
    simulation,
    stiffness,
    summary,
    tracking,
    transfer,
)
from tsas_cli.reporting.tracking_file import Tracking

SECTIONS: tuple[Callable[[Inputs], Section | None], ...] = (
    tracking.section,
    diagnosis.section,
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

    A page of tracked runs leaves out what was not given; any other page says what is missing.

    Raises
    ------
    InputError
        A recording or a simulated run cannot be read.
    """
    tracked = inputs.get(Tracking) is not None
    sections = []
    for make in SECTIONS:
        section = make(inputs)
        if section is not None and (section.given or not tracked):
            sections.append(section)
        advance()
    return rendered(
        name=inputs.dataset.manifest.name,
        about="recordings, model and residual",
        summary=" ".join(summary.sentences(inputs)),
        sections=sections,
    )
