"""What the subcommands share: their options, and how a result and hints are printed."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tsas_cli.commands.completion import run_ids
from tsas_cli.errors import printable

if TYPE_CHECKING:
    from tsas_cli.result import Result

DatasetFolder = Annotated[Path, typer.Argument(metavar="DATASET", help="A dataset's folder.")]
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="The folder to write.")]
ModelFile = Annotated[
    Path | None,
    typer.Option("--model", metavar="M.toml", help="The model; the data sheet's without it."),
]
ChosenRuns = Annotated[
    str | None,
    typer.Option(
        "--runs",
        metavar="IDS",
        help="Only these runs, with commas between; else all.",
        autocompletion=run_ids,
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace the output if it is there.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON instead of a table.")]


def names(listed: str | None) -> list[str] | None:
    """Return what stands between the commas of an option, or None where it was not given."""
    return None if listed is None else [name.strip() for name in listed.split(",")]


def present(result: "Result", *, quiet: bool, as_json: bool) -> None:
    """Print a stage's result on standard output: as JSON, or its tables and sentences."""
    if not (quiet or as_json):
        for line in result.intro():
            print(line)
    show(result.summary, result.tables(), result.sentences(), quiet=quiet, as_json=as_json)


def show(
    summary: dict[str, Any],
    tables: Iterable[tuple[str, Sequence[str], Sequence[Sequence[str]]]],
    sentences: Iterable[str] = (),
    *,
    quiet: bool,
    as_json: bool,
) -> None:
    """Print a summary as JSON, or tables (title, header, rows) and the sentences below them."""
    if as_json:
        from tsas_cli.files import json_text

        sys.stdout.write(json_text(summary))
    elif not quiet:
        for title, header, rows in tables:
            _print_table(title, header, rows)
        for sentence in sentences:
            print(printable(sentence))


def hint(text: str, *, quiet: bool, as_json: bool) -> None:
    """Say to a person at a terminal, on standard error, what else the program can do."""
    if sys.stderr.isatty() and not (quiet or as_json):
        print(text, file=sys.stderr)


def _print_table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    print(printable(title))
    if rows:
        lines = [[printable(str(cell)) for cell in row] for row in (header, *rows)]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        lines.insert(1, ["-" * width for width in widths])
        for line in lines:
            cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
            print("  " + "  ".join(cells).rstrip())
    print()
