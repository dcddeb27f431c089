"""Colours by role: drawn as stand-ins, then named in the page's style, once light and once dark."""

CONTROLLERS = ("pid", "sliding-mode", "adaptive-sliding-mode", "disturbance-observer")
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
    *CONTROLLERS,
)
STAND_IN = {role: f"#c0ff{number:02x}" for number, role in enumerate(ROLES)}


def of_controller(name: str) -> str:
    """Return the stand-in of a controller's colour, the same in every plot."""
    return STAND_IN[name if name in CONTROLLERS else "unknown"]


def themed(svg: str) -> str:
    """Return the SVG text with every stand-in replaced by the style's variable of its role."""
    for role, colour in STAND_IN.items():
        svg = svg.replace(colour, f"var(--{role})")
    return svg
