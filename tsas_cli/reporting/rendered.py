"""From sections to one HTML file that needs nothing else."""

import re
from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from tsas_cli.reporting.content import Glance, Section
from tsas_cli.support import __version__
from tsas_cli.support.errors import printable


def rendered(
    *,
    name: str,
    about: str,
    summary: str,
    sections: Sequence[Section],
    glance: Glance | None = None,
) -> str:
    """Return a page as HTML.

    `about` follows the name in the window's title; what stands between backticks in the summary
    becomes code. Each of the sections is in the contents, and so are its parts; `glance` stands
    above all.
    """
    environment = Environment(
        loader=PackageLoader("tsas_cli.reporting"),
        autoescape=True,
        finalize=_visible,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = _prose
    script = (files("tsas_cli.reporting") / "templates" / "figures.js").read_text(encoding="utf-8")
    return environment.get_template("page.html").render(
        name=name,
        about=about,
        summary=summary,
        sections=sections,
        glance=glance,
        version=__version__,
        script=Markup(script),  # noqa: S704  our own, and the one that the page allows
        digest=b64encode(sha256(script.encode()).digest()).decode(),
    )


def _prose(text: str) -> Markup:
    """Escape a sentence; what stands between backticks in it becomes code."""
    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(printable(text)))))  # noqa: S704


def _visible(value: object) -> object:
    """Make control characters in names from files visible; leave our own markup as it is."""
    return value if isinstance(value, Markup) else printable(str(value))
