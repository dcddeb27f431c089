"""The page that a person reads: every section in order, in one file that needs nothing else."""

import re
from collections.abc import Callable

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from tsas_cli.errors import printable
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.sections import (
    diagnosis,
    drive,
    loops,
    parameters,
    recordings,
    repeat,
    simulation,
    stiffness,
    summary,
    transfer,
)
from tsas_cli.reporting.stage_files import Calibration, Diagnosis, Drive, Simulation

SECTIONS: tuple[Callable[[Inputs], Section], ...] = (
    diagnosis.section,
    drive.section,
    recordings.section,
    stiffness.section,
    transfer.section,
    loops.section,
    simulation.section,
    parameters.section,
    repeat.section,
)


_OF_THE_DRIVE = (drive.section, recordings.section, repeat.section)


def sections_for(inputs: Inputs) -> tuple[Callable[[Inputs], Section], ...]:
    """Return the sections of a page: of the drive, of the tendon, or of both, as was given."""
    if inputs.get(Drive) is None:
        return tuple(section for section in SECTIONS if section is not drive.section)
    tendon = any(inputs.get(kind) for kind in (Calibration, Simulation, Diagnosis))
    return SECTIONS if tendon else _OF_THE_DRIVE


def page(inputs: Inputs, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each section.

    Raises
    ------
    InputError
        A recording or a simulated run cannot be read.
    """
    sections = []
    for section in sections_for(inputs):
        sections.append(section(inputs))
        advance()
    environment = Environment(
        loader=PackageLoader("tsas_cli.reporting"),
        autoescape=True,
        finalize=_visible,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = _prose
    return environment.get_template("page.html").render(
        name=inputs.dataset.manifest.name,
        summary=" ".join(summary.sentences(inputs)),
        sections=sections,
    )


def _prose(text: str) -> Markup:
    """Escape a sentence; what stands between backticks in it becomes code."""
    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(printable(text)))))  # noqa: S704


def _visible(value: object) -> object:
    """Make control characters in names from files visible; leave our own markup as it is."""
    return value if isinstance(value, Markup) else printable(str(value))
