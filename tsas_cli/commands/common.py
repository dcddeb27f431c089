"""Common options of the subcommands, their progress bar, and the printing of results and hints."""

import csv
import logging
import os
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tsas_cli.commands.bar import Bar
from tsas_cli.commands.completion import run_ids
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.stopping import EXIT_CODE, asked_first
from tsas_cli.support.text_table import table_text

if TYPE_CHECKING:
    from tsas_cli.records.result import Result
    from tsas_cli.reporting.stream.live import LiveStream


def names(listed: str | None) -> list[str] | None:
    """Return the comma-separated names of an option, one with a comma in quotes; or None."""
    rows = csv.reader((listed or "").splitlines(), skipinitialspace=True, strict=True)
    try:
        return None if listed is None else [name.strip() for row in rows for name in row] or [""]
    except csv.Error as error:
        raise InputError(
            f"the list {listed!r} has an open quote", expected='names, one with a comma as "a,b"'
        ) from error


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
        help="Only these runs, comma-separated (one with a comma in quotes); default: all.",
        autocompletion=run_ids,
        callback=names,
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


def run(
    stage: Callable[..., Any],
    *,
    rrd: bool = False,
    endable: bool = False,
    quiet: bool,
    as_json: bool,
    **given: Any,
) -> Any:
    """Return the result of a stage, called under a progress bar, after printing it.

    `given` are its arguments, by name as the command has them; those that are None were not asked
    for. With `rrd` the stage also writes `stream.rrd`. A search, `endable`, that was ended before
    it could decide has the exit code of a command that was stopped.
    """
    asked = {name: value for name, value in given.items() if value is not None}
    label = stage.__name__.replace("_", "-")
    with progress(label, quiet=quiet, endable=endable) as step, with_stream(rrd, step):
        result = stage(**asked, step=step)
    present(result, quiet=quiet, as_json=as_json)
    if step.ended and result.verdict == "undecided":
        raise typer.Exit(EXIT_CODE)
    return result


def present(result: "Result", *, quiet: bool, as_json: bool) -> None:
    """Print a stage's result on standard output: as JSON, or its tables and sentences."""
    with printed(result.out):
        if not (quiet or as_json):
            for line in result.intro():
                print(line)
        show(result.summary, result.tables(), result.sentences(), quiet=quiet, as_json=as_json)


@contextmanager
def printed(out: object) -> Iterator[None]:
    """Say where standard output is refused that the result in the block is written, if it is."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        done = f"{out} is complete: only what is printed is lost"
        raise InputError(
            f"cannot be written ({error.strerror})",
            where="standard output",
            remedy=done if out else "make room, and repeat the call",
        ) from error


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
    from tsas_cli.support.stopping import until_stopped

    with opened(in_browser=not has_screen()) as viewer:
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


@contextmanager
def progress(label: str, *, quiet: bool, endable: bool = False) -> Iterator[Steps]:
    """Show a bar while a stage runs, unless it is quiet; yield the receiver of its steps.

    Where the stage is `endable`, the first Ctrl-C ends its search; not under make, which removes
    the target of a recipe that is stopped.
    """
    if quiet:
        logging.getLogger("tsas").setLevel(logging.ERROR)
    if quiet or not sys.stderr.isatty():
        yield NO_PROGRESS
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=20),
        MofNCompleteColumn(separator=" of "),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        bar = Bar(shown, label)
        log = logging.getLogger("tsas")
        level = log.level
        log.setLevel(logging.INFO)
        log.addHandler(bar)
        try:
            with (
                asked_first(bar.end) if endable and "MAKELEVEL" not in os.environ else nullcontext()
            ):
                yield bar
        finally:
            log.removeHandler(bar)
            log.setLevel(level)
