"""What the subcommands share: their options, the table they print, and the summary they write."""

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tsas_cli.errors import printable

if TYPE_CHECKING:
    from tsas_cli.recordings.dataset import Dataset

DatasetFolder = Annotated[Path, typer.Argument(metavar="DATASET", help="A dataset's folder.")]
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="The folder to write.")]
ModelFile = Annotated[
    Path | None,
    typer.Option("--model", metavar="M.toml", help="The model; the data sheet's without it."),
]
ChosenRuns = Annotated[
    str | None,
    typer.Option("--runs", metavar="IDS", help="Only these runs, with commas between; else all."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace the output if it is there.")]
Rrd = Annotated[
    bool, typer.Option("--rrd", help="Also write DIR/stream.rrd, to be looked at with tsas view.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON instead of a table.")]


def opened(folder: Path, runs: str | None) -> "Dataset":
    """Open a dataset with the runs that were asked for.

    Raises
    ------
    InputError
        It is none, or has no such run.
    """
    from tsas_cli.recordings.dataset import read_dataset

    dataset = read_dataset(folder)
    return dataset if runs is None else dataset.only(name.strip() for name in runs.split(","))


def add_stream(folder: Path, *folders: Path, quiet: bool) -> None:
    """Write `stream.rrd` into a folder that a stage has finished.

    It shows what stands in that folder, or in `folders` where they are given.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    from tsas_cli.reporting.inputs import read_inputs
    from tsas_cli.reporting.stream import FILE, write_stream

    inputs = read_inputs(folders or (folder,))
    runs = 0 if inputs.dataset is None else len(inputs.dataset.runs)
    with progress("recording", runs, quiet=quiet) as step:
        write_stream(inputs, folder / FILE, force=True, step=step)


def show(
    summary: dict[str, Any],
    tables: Iterable[tuple[str, Sequence[str], Sequence[Sequence[str]]]],
    *,
    quiet: bool,
    as_json: bool,
) -> None:
    """Print a stage's result: its summary as JSON, or its tables (title, header, rows)."""
    if as_json:
        from tsas_cli.files import json_text

        sys.stdout.write(json_text(summary))
    elif not quiet:
        for title, header, rows in tables:
            _print_table(title, header, rows)


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


@contextmanager
def progress(label: str, total: int | None, *, quiet: bool) -> Iterator[Any]:
    """Show a bar on a terminal; yield a function that moves it by one.

    Without a total the bar only shows that work goes on.
    """
    if quiet or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=total)
        yield lambda: bar.advance(task)
