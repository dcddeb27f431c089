"""Draw docs/house.svg from the import contract: `.venv/bin/python -m docs.house`.

The floors are those that import-linter holds the imports to (pyproject.toml); what a room holds is
the first line of its docstring.
"""

import ast
import textwrap
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).parents[1]
OUT = Path(__file__).parent / "house.svg"
WIDTH, MARGIN, LINE, GAP = 960, 8, 15, 6  # px
CHARACTER = 5.9  # px, of the text in a room
STYLE = """
text { font: 11px system-ui, sans-serif; fill: #1f2328 }
.name { font: 600 13px ui-monospace, monospace }
rect { fill: #eef2f7; stroke: #b6c2d1 }
@media (prefers-color-scheme: dark) {
  text { fill: #e6edf3 } rect { fill: #1c2530; stroke: #45566b }
}
"""


def floors() -> list[list[str]]:
    """Return the rooms of each floor, the topmost first, as the import contract names them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (layers,) = (
        contract["layers"]
        for contract in project["tool"]["importlinter"]["contracts"]
        if contract["type"] == "layers"
    )
    return [[room.strip() for room in floor.split("|")] for floor in layers]


def summary(room: str) -> str:
    """Return the first line of the docstring of a package or module."""
    path = ROOT.joinpath(*room.split("."))
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    text = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8")))
    if not text:
        raise SystemExit(f"{source} has no docstring")
    return text.splitlines()[0].replace("`", "").removesuffix(".")


def svg() -> str:
    """Return the picture: one row of rooms a floor, each with its name and what it holds."""
    parts, top = [], MARGIN
    for floor in floors():
        width = (WIDTH - 2 * MARGIN - GAP * (len(floor) - 1)) / len(floor)
        texts = [textwrap.wrap(summary(room), int((width - 16) / CHARACTER)) for room in floor]
        height = LINE * (1 + max(map(len, texts))) + 12
        for i, (room, lines) in enumerate(zip(floor, texts, strict=True)):
            left = MARGIN + i * (width + GAP)
            suffix = "/" if ROOT.joinpath(*room.split(".")).is_dir() else ".py"
            name = room.removeprefix("tsas_cli.") + suffix
            parts += [
                f'<rect x="{left:.1f}" y="{top}" width="{width:.1f}" height="{height}" rx="4"/>',
                f'<text class="name" x="{left + 8:.1f}" y="{top + 18}">{name}</text>',
            ]
            parts += [
                f'<text x="{left + 8:.1f}" y="{top + 18 + LINE * (k + 1)}">{escape(line)}</text>'
                for k, line in enumerate(lines)
            ]
        top += height + GAP
    size = f'width="{WIDTH}" height="{top - GAP + MARGIN}"'
    body = "\n".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n<style>{STYLE}</style>\n{body}\n</svg>\n'
    )


if __name__ == "__main__":
    OUT.write_text(svg(), encoding="utf-8")
