"""The reference of the Python API: what `import tsas_cli as tsas` gives, from its docstrings."""

import inspect
import re
import textwrap
from typing import Any

import tsas_cli

UNDERLINED = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)
FIELD = re.compile(r"^(\S[^\n]*)\n((?:    [^\n]*\n?|\n)*)", re.MULTILINE)


def api_page() -> str:
    """Return the page: a section for each public name, functions before classes."""
    things = [(name, getattr(tsas_cli, name)) for name in tsas_cli.__all__]
    functions = [(name, thing) for name, thing in things if not inspect.isclass(thing)]
    classes = [(name, thing) for name, thing in things if inspect.isclass(thing)]
    lines = [
        "# Python API, call by call",
        (
            "\n`import tsas_cli as tsas` gives notebooks and programs what the commands do, by the "
            "same functions. Units stand in the names; arrays are float64 of shape (n,), NaN for "
            "gaps."
        ),
    ]
    for name, thing in (*functions, *classes):
        lines.append(f"\n## tsas.{name}\n\n```python\n{_signature(name, thing)}\n```")
        lines += _body(inspect.getdoc(thing) or "")
    return "\n".join(lines) + "\n"


def _signature(name: str, thing: Any) -> str:
    """Return how it is called, one argument a line where there are many; types by short names."""
    if inspect.isclass(thing):
        return f"class tsas.{name}"
    signature = inspect.signature(thing)
    shown = re.sub(r"\b(?:[a-z_]\w*\.)+(?=[A-Z])", "", str(signature))
    shown = re.sub(r" = <[^>]*>", " = …", shown)
    if len(shown) > 80:
        inside, _, returned = shown[1:].rpartition(") -> ")
        parts = re.split(r", (?=\*|\w+: )", inside)
        shown = "(\n    " + ",\n    ".join(parts) + f",\n) -> {returned}"
    return f"tsas.{name}{shown}"


def _body(doc: str) -> list[str]:
    """Return a docstring of numpy's form as Markdown."""
    pieces = UNDERLINED.split(doc)
    lines = [f"\n{pieces[0].strip()}"]
    for title, text in zip(pieces[1::2], pieces[2::2], strict=True):
        if title == "Examples":
            lines.append(f"\n```python\n{text.strip()}\n```")
        elif title == "Parameters":
            lines.append("\n| argument | |\n|---|---|")
            lines += [f"| `{name}` | {_flat(about)} |" for name, about in FIELD.findall(text)]
        else:
            found = FIELD.findall(text)
            lines += [f"\n**{title}** `{name}`: {_flat(about)}" for name, about in found]
    return lines


def _flat(text: str) -> str:
    return " ".join(textwrap.dedent(text).split()).replace("|", "\\|")
