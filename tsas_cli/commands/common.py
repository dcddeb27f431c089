"""Common options of the subcommands, and the printing of results and hints."""

import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tsas_cli.commands.completion import run_ids
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.text_table import table_text

if TYPE_CHECKING:
    from tsas_cli.records.result import Result
    from tsas_cli.reporting.stream.live import LiveStream
    from tsas_cli.support.steps import Steps

Live = Annotated[
    bool, typer.Option("--live", help="Show each run in the viewer as soon as it is computed.")
]
DatasetFolder = Annotated[
    str, typer.Argument(metavar="DATASET", help="A dataset's folder, or its address (s3://…).")
]
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="The folder to write.")]
ModelOption = Annotated[
    Path | None,
    typer.Option("--model", metavar="M.toml", help="The model; default: from the data sheet."),
]
ChosenRuns = Annotated[
    str | None,
    typer.Option(
        "--runs",
        metavar="IDS",
        help="Only these runs, comma-separated; default: all.",
        autocompletion=run_ids,
    ),
]
Despite = Annotated[
    list[str] | None,
    typer.Option("--despite", metavar="CODE", help="Accept errors of this check; may be repeated."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace an existing output.")]
Rrd = Annotated[bool, typer.Option("--rrd", help="Also write DIR/stream.rrd for tsas view.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON instead of a table.")]


def names(listed: str | None) -> list[str] | None:
    """Return the comma-separated names of an option, or None without it."""
    return None if listed is None else [name.strip() for name in listed.split(",")]


def present(result: "Result", *, quiet: bool, as_json: bool) -> None:
    """Print a stage's result on standard output: as JSON, or its tables and sentences."""
    if not (quiet or as_json):
        for line in result.intro():
            print(line)
    show(result.summary, result.tables(), result.sentences(), quiet=quiet, as_json=as_json)


Streams = Callable[[Path], Iterable[tuple[Path, Sequence[Path]]]]


def with_stream(
    wanted: bool, step: "Steps", of: Streams = lambda folder: [(folder, [folder])]
) -> AbstractContextManager[None]:
    """Let the stage in the block also write `stream.rrd`, before its folder gets its name.

    `of` maps the stage's folder to the folder of each stream and the folders that it shows. `step`
    counts one step per run.
    """
    from tsas_cli.support.files import extra_output

    def add(folder: Path) -> None:
        from tsas_cli.reporting.inputs import read_inputs
        from tsas_cli.reporting.stream import STREAM_FILE, write_stream

        for home, shown in of(folder):
            inputs = read_inputs(shown)
            step.ahead(0 if inputs.dataset is None else len(inputs.dataset.runs))
            write_stream(inputs, home / STREAM_FILE, step=step)

    return extra_output(add if wanted else None)


def show(
    summary: object,
    tables: Iterable[tuple[str, Sequence[str], Sequence[Sequence[str]]]],
    sentences: Iterable[str] = (),
    *,
    quiet: bool,
    as_json: bool,
) -> None:
    """Print a summary as JSON, or tables (title, header, rows) and the sentences below them."""
    if as_json:
        from tsas_cli.support.files import json_text

        sys.stdout.write(json_text(summary))
    elif not quiet:
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        for title, header, rows in tables:
            for line in table_text(title, header, rows, width):
                print(line)
            print()
        for sentence in sentences:
            print(printable(sentence))


def hint(text: str, *, quiet: bool, as_json: bool) -> None:
    """Print a hint on standard error, if it is a terminal."""
    if sys.stderr.isatty() and not (quiet or as_json):
        print(text, file=sys.stderr)


def not_shown(*run: object) -> None:
    """Ignore a run."""
    del run


@contextmanager
def watched(live: bool, name: str, *, quiet: bool) -> Iterator["LiveStream | None"]:
    """Open the viewer, yield its stream, and wait until it is closed; yield None without `live`.

    Messages go to standard error: standard output holds the stage's result only.
    """
    if not live:
        yield None
        return
    from tsas_cli.reporting.stream.live import live_stream
    from tsas_cli.reporting.viewer.open import has_screen, note_once, opened
    from tsas_cli.support.stopping import cleaned_up_when_stopped, until_stopped

    with cleaned_up_when_stopped(), opened(in_browser=not has_screen()) as viewer:
        _report(note_once(), f"live at {viewer.page}" if viewer.page else "", quiet=quiet)
        computed, failure = False, None
        try:
            with live_stream(viewer.proxy, name) as stream:
                yield stream
                failure = stream.failure
                computed = True
        except InputError as error:
            if not computed:
                raise
            failure = error
        if failure is not None:
            _report(f"some runs were not shown, but all are written: {failure.line()}", quiet=quiet)
            return
        sys.stdout.flush()
        end = "Ctrl-C" if viewer.page else "close the window or press Ctrl-C"
        _report(f"all runs are shown and written; {end} to end the viewer", quiet=quiet)
        with until_stopped():
            viewer.child.wait()


def _report(*sentences: str, quiet: bool) -> None:
    for sentence in sentences:
        if sentence and not quiet:
            print(f"- {sentence}", file=sys.stderr, flush=True)
