"""To look at: `tsas report` and `view`; to look up: `tsas effects` and `explain`."""

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress, run, show
from tsas_cli.commands.completion import effect_names


def report(
    folders: Annotated[list[str], typer.Argument(metavar="DIR", help="Output folders of stages.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The HTML page to write.")],
    pdf: Annotated[
        bool, typer.Option("--pdf", help="Also print the page to PDF; requires Chromium.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Each DIR is a dataset or an output of `tsas check`, `calibrate`, `simulate` or `diagnose`. An
    output of `tsas track`, `close-loop` or `identify-harmonic-drive` has a page of its own. Several
    simulations stand beside each other, each by the name of its folder.

    With `--pdf`, report.html is also printed to report.pdf.
    """
    run(tsas.report, **locals())


def view(
    paths: Annotated[
        list[str], typer.Argument(metavar="PATH", help="An .rrd file, or output folders.")
    ],
    web: Annotated[
        bool, typer.Option("--web", help="Use the browser even if a window can be opened.")
    ] = False,
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="The viewer's port; default: any.")
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Show measured and simulated signals and findings over time in a viewer.

    Each PATH is a dataset or an output of a stage, all in one stream; or one .rrd file. A window
    opens; without a screen, a page is served and its address printed.
    """
    from tsas_cli.recordings.storage import location_of
    from tsas_cli.reporting.stream.stream import shown_stream
    from tsas_cli.reporting.viewer.open import has_screen, note_once, opened
    from tsas_cli.support.stopping import until_stopped

    in_browser = web or not has_screen()
    with until_stopped(), ExitStack() as stack:
        with progress("stream", quiet=quiet) as step:
            stream, notes = stack.enter_context(
                shown_stream([location_of(path) for path in paths], step)
            )
        viewer = stack.enter_context(opened(stream, in_browser=in_browser, port=port))
        end = "Ctrl-C ends it" if in_browser else "close the window or press Ctrl-C to end it"
        talk = () if quiet else (*notes, note_once(), end)
        for sentence in filter(None, talk):
            print(f"- {sentence}", file=sys.stderr)
        summary = {"stage": "view", "stream": str(stream), "address": viewer.page or None}
        show(summary, (), quiet=quiet, as_json=as_json)
        if viewer.page and not quiet and not as_json:
            print(viewer.page)
        sys.stdout.flush()
        viewer.child.wait()


def effects(quiet: Quiet = False, as_json: Json = False) -> None:
    """List the effects by which a real rig differs from the nominal model."""
    present(tsas.catalogue(), quiet=quiet, as_json=as_json)
    if sys.stderr.isatty() and not (quiet or as_json):
        print("`tsas explain NAME` describes an effect", file=sys.stderr)


def explain(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME", help="An effect of `tsas effects`.", autocompletion=effect_names
        ),
    ],
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Describe an effect: its signature, equation, parameters and isolating experiment."""
    present(tsas.explain(name), quiet=quiet, as_json=as_json)
