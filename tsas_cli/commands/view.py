"""`tsas view`: look at recordings, and at what the stages found, in the viewer."""

import sys
from contextlib import ExitStack
from typing import Annotated

import typer

from tsas_cli.commands.common import Json, Quiet, show
from tsas_cli.commands.progress import progress

ENDS = {True: "Ctrl-C ends it", False: "close the window or press Ctrl-C to end it"}


def view(
    paths: Annotated[
        list[str], typer.Argument(metavar="PATH", help="An .rrd file, or folders of stages.")
    ],
    web: Annotated[
        bool, typer.Option("--web", help="In the browser, even where a window can be opened.")
    ] = False,
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="The viewer's port; any without it.")
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Show what was measured, simulated and found, over time, until you close it.

    Each PATH is a dataset or what a stage wrote, together one stream; or one .rrd file. A window
    opens, and where there is no screen a page is served whose address is printed.
    """
    from tsas_cli.recordings.storage import place_of
    from tsas_cli.reporting.viewer.analytics import note_once
    from tsas_cli.reporting.viewer.open import opened
    from tsas_cli.reporting.viewer.screen import has_screen
    from tsas_cli.reporting.viewer.stream_of import stream_of
    from tsas_cli.support.stopping import until_stopped

    in_browser = web or not has_screen()
    with until_stopped(), ExitStack() as held:
        with progress("stream", quiet=quiet) as step:
            stream, notes = held.enter_context(stream_of([place_of(path) for path in paths], step))
        viewer = held.enter_context(opened(stream, in_browser=in_browser, port=port))
        talk = () if quiet else (*notes, note_once(), ENDS[in_browser])
        for sentence in filter(None, talk):
            print(f"- {sentence}", file=sys.stderr)
        summary = {"stage": "view", "stream": str(stream), "address": viewer.page or None}
        show(summary, (), quiet=quiet, as_json=as_json)
        if viewer.page and not quiet and not as_json:
            print(viewer.page)
        sys.stdout.flush()
        viewer.child.wait()
