"""What the documentation says that a stage writes."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def documented(section: str, page: str = "formats.md") -> set[str]:
    """Return the keys in the table of a section of a page."""
    text = (DOCS / page).read_text(encoding="utf-8").split(f"## {section}")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \|", text, flags=re.MULTILINE)
    return {key for row in rows for key in re.findall(r"`(\w+)`", row)}
