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
