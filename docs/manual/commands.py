"""The command reference: every command as the program itself describes it."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

ROOT = Path(__file__).parents[2]
SHOWN_IN = (
    "docs/tutorial.md",
    "README.md",
    *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")),
)


def command_page() -> str:
    """Return the page of all commands."""
    lines = [
        "# Command reference",
        (
            "\nFrom the program's own `--help`. Every command prints JSON with `--json` and "
            "nothing but errors with `--quiet`. Exit codes: 0 done; 2 the call or the input is "
            "wrong, said in one line, with nothing half-written; 1 a defect of ours."
        ),
        "\n| command | |\n|---|---|",
    ]
    found = list(commands())
    lines += [
        f"| [`{name.removeprefix('tsas ')}`](#{_anchor(name)}) | {_sentence(c)} |"
        for name, c in found
    ]
    for name, command in found:
        lines += _section(name, command)
    return "\n".join(lines) + "\n"


def commands() -> Iterator[tuple[str, Any]]:
    """Yield every command with its whole name; a group's commands stand in its place."""
    from tsas_studies.commands import app

    for name, command in typer.main.get_command(app).commands.items():  # type: ignore[attr-defined]
        inner = getattr(command, "commands", None)
        if inner is None:
            yield f"tsas {name}", command
        else:
            yield from ((f"tsas {name} {part}", call) for part, call in inner.items())


def example(name: str) -> tuple[str, str]:
    """Return the first call of a command in the pages, one that is run before others, and where.

    Raises
    ------
    LookupError
        No page shows the command.
    """
    for prompt in (r"\$ ", ""):
        call = re.compile(
            rf"^{prompt}({re.escape(name)}(?![\w-])[^\n]*?)( +#[^\n]*)?$", re.MULTILINE
        )
        for page in SHOWN_IN:
            text = (ROOT / page).read_text(encoding="utf-8") if (ROOT / page).is_file() else ""
            if found := call.search(text):
                return found[1], page
    raise LookupError(f"no page shows `{name}`")


def _section(name: str, command: Any) -> list[str]:
    context = typer.Context(command, info_name=name)
    usage = " ".join(command.collect_usage_pieces(context))
    lines = [f"\n## {name}\n\n{command.help}\n\n```console\n$ {name} {usage}\n```"]
    for kind in ("argument", "option"):
        records = [p.get_help_record(context) for p in command.params if p.param_type_name == kind]
        if records:
            lines.append(f"\n| {kind} | |\n|---|---|")
            lines += [f"| `{_cell(names)}` | {_cell(about)} |" for names, about in records]
    call, page = example(name)
    title = "the README"
    if page != "README.md":
        place = page.removeprefix("docs/")
        title = f"[{place.removesuffix('.md').replace('-', ' ')}]({place})"
    lines.append(f"\nFor example, from {title}:\n\n```console\n$ {call}\n```")
    return lines


def _cell(text: str) -> str:
    """Return text as it stands in a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def _sentence(command: Any) -> str:
    return _cell(command.help.split("\n\n")[0])


def _anchor(name: str) -> str:
    return name.replace(" ", "-")
