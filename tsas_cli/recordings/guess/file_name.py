"""The numbers in a file's name that look like conditions of a run."""

import re
from pathlib import Path

# Words that stand before a number, and the units that such a number has.
_BEFORE = {
    "total_bend_rad": ("bend", r"bend|bending|theta|wrap|biegung|winkel|angle", "deg"),
    "sheath_length_mm": ("length", r"length|len|laenge|sheath|l", "mm"),
    "preload_N": ("preload", r"preload|pretension|vorspannung|vorlast|f0", "N"),
}
_NUMBER = r"\d+(?:\.\d+)?"


def conditions_in(path: Path) -> tuple[str, dict[str, tuple[str, str]]]:
    """Return a pattern for a file's name, and group and likely unit of each condition in it.

    Both are empty where no word of a condition stands before a number.
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
