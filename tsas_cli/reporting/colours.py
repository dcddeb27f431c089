"""Colours by role: drawn as stand-ins, then named in the page's style, once light and once dark."""

ROLES = (
    "ink",
    "muted",
    "line",
    "paper",
    "measured",
    "simulated",
    "contraction",
    "loosening",
    "dead-band-up",
    "dead-band-down",
    "rest",
    "unknown",
    "before",
    "after",
    "alike",
)
STAND_IN = {role: f"#c0ffe{number:x}" for number, role in enumerate(ROLES)}


def themed(svg: str) -> str:
    """Return the SVG text with every stand-in replaced by the style's variable of its role."""
    for role, colour in STAND_IN.items():
        svg = svg.replace(colour, f"var(--{role})")
    return svg
