"""The colours of the report for the dark background of the viewer."""

from tsas_cli.reporting.colours import schemes

OPAQUE = 0xFF


def colour(role: str, opacity: int = OPAQUE) -> int:
    """Return the colour of a role of `reporting.colours` as 0xRRGGBBAA."""
    _, dark = schemes()
    return int(dark[role].removeprefix("#"), 16) << 8 | opacity
