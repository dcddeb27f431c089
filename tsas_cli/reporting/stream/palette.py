"""The colours of the report for the dark background of the viewer."""

import re
from functools import cache
from importlib.resources import files

OPAQUE = 0xFF


def colour(role: str, opacity: int = OPAQUE) -> int:
    """Return the colour of a role of `reporting.colours` as 0xRRGGBBAA."""
    return _dark()[role] << 8 | opacity


@cache
def _dark() -> dict[str, int]:
    """Read the page's dark scheme, the second one of its style."""
    style = files("tsas_cli.reporting").joinpath("templates/page.css").read_text(encoding="utf-8")
    dark = re.findall(r":root \{(.*?)\}", style, re.DOTALL)[1]
    return {role: int(code, 16) for role, code in re.findall(r"--([\w-]+): #([0-9a-f]{6})", dark)}
