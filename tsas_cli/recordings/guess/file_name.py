"""Conditions of a run from the numbers in a file name."""

import re
from pathlib import Path

# Group, words before the number, and likely unit.
_BEFORE = {
    "total_bend_rad": ("bend", r"bend|bending|theta|wrap|biegung|winkel|angle", "deg"),
    "sheath_length_mm": ("length", r"length|len|laenge|sheath|l", "mm"),
    "preload_N": ("preload", r"preload|pretension|vorspannung|vorlast|f0", "N"),
}
_NUMBER = r"\d+(?:\.\d+)?"


def conditions_in(path: Path) -> tuple[str, dict[str, tuple[str, str]]]:
    """Return a pattern for a file name, and group and likely unit of each condition in it.

    Both are empty without a word of a condition before a number.
    """
    found: list[tuple[int, str, str]] = []
    groups: dict[str, tuple[str, str]] = {}
    for condition, (group, words, unit) in _BEFORE.items():
        match = re.search(rf"(?i)(?<![a-z])({words})([_=-]?){_NUMBER}", path.stem)
        if match:
            text = f"{re.escape(match[1] + match[2])}(?P<{group}>{_NUMBER})"
            found.append((match.start(), text, condition))
            groups[condition] = (group, unit)
    return ".*?".join(text for _, text, _ in sorted(found)), groups
