"""`--live`: the viewer shows each run of a stage as soon as it is computed."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from tsas_cli.support.errors import InputError

if TYPE_CHECKING:
    from tsas_cli.reporting.stream.live import LiveStream

Live = Annotated[
    bool, typer.Option("--live", help="Show each run in the viewer as soon as it is computed.")
]


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
