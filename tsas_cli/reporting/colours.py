"""Colours by role: drawn as stand-ins, then named in the page's style, once light and once dark."""

import re
from functools import cache
from importlib.resources import files

from tsas_cli.controllers import CONTROLLERS

SERIES = ("first", "second", "third", "fourth")  # of controllers, in their order
MODELS = ("data-sheet", "calibrated", "extended", "true")


@cache
def schemes() -> tuple[dict[str, str], dict[str, str]]:
    """Return the light and the dark scheme of `colours.css`: colours as #rrggbb by role."""
    style = files("tsas_cli.reporting") / "templates" / "colours.css"
    blocks = re.findall(r":root \{(.*?)\}", style.read_text(encoding="utf-8"), re.DOTALL)
    light, dark = (dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block)) for block in blocks)
    return light, dark


STAND_IN = {role: f"#c0ff{number:02x}" for number, role in enumerate(schemes()[0])}


def dark(role: str) -> int:
    """Return a role's colour on a dark ground, as the viewer has it, as 0xRRGGBBAA."""
    _, scheme = schemes()
    return int(scheme[role].removeprefix("#"), 16) << 8 | 0xFF


def role_of_controller(name: str) -> str:
    """Return the role of a controller's colour, the same in every plot."""
    if name not in CONTROLLERS:
        return "unknown"
    return SERIES[CONTROLLERS.index(name) % len(SERIES)]


def of_controller(name: str) -> str:
    """Return the stand-in of a controller's colour."""
    return STAND_IN[role_of_controller(name)]


def themed(svg: str) -> str:
    """Return the SVG text with every stand-in replaced by the style's variable of its role."""
    for role, colour in STAND_IN.items():
        svg = svg.replace(colour, f"var(--{role})")
    return svg
