"""A progress bar on standard error, if it is a terminal, with the remaining time."""

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from datetime import timedelta
from typing import TYPE_CHECKING

from tsas_cli.support.errors import printable
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.stopping import asked_first

if TYPE_CHECKING:
    from rich.progress import Progress

ENDS = (
    "Ctrl-C: the search ends after this step, and what it has found is written; "
    "Ctrl-C again stops at once and writes nothing"
)


class Bar(Steps):
    """A progress bar, whose total grows with the announced steps.

    The remaining time is that of the steps that were announced together, at their pace: those
    before may have been of another kind.
    """

    def __init__(self, shown: "Progress", label: str) -> None:
        self.shown, self.label, self.total, self.done = shown, label, 0, 0
        self.before, self.since_s = 0, 0.0  # steps, and time, before those that are under way
        self.task = shown.add_task(label, total=None, left="")

    def ahead(self, pieces: int) -> None:
        """Add steps to the total."""
        self.before, self.since_s = self.done, self._elapsed_s()
        self.total += pieces
        self._show()

    def __call__(self) -> None:
        """Count one completed step."""
        self.done += 1
        self._show()

    def doing(self, what: str) -> None:
        """Show what is done from now on."""
        self.shown.update(self.task, description=printable(f"{self.label}: {what}"))

    def say(self, sentence: str) -> None:
        """Print a sentence above the bar."""
        self.shown.console.print(printable(sentence), markup=False, highlight=False)

    def end(self) -> None:
        """Ask a search to end at its next step."""
        self.ended = True
        self.say(ENDS)

    def _elapsed_s(self) -> float:
        return self.shown.tasks[0].elapsed or 0.0

    def _show(self) -> None:
        """Draw the bar, with the remaining time at the pace so far."""
        rest, left = self.total - self.done, ""
        if self.done > self.before and rest > 0:
            pace_s = (self._elapsed_s() - self.since_s) / (self.done - self.before)
            left = f"about {timedelta(seconds=round(pace_s * rest))} left"
            left += " of these" if self.before else ""
        self.shown.update(self.task, total=self.total or None, completed=self.done, left=left)


class _Said(logging.Handler):
    """What the package logs, above the bar."""

    def __init__(self, bar: Bar) -> None:
        super().__init__()
        self.bar = bar

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record."""
        self.bar.say(record.getMessage())


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
        log, said = logging.getLogger("tsas"), _Said(bar)
        level = log.level
        log.setLevel(logging.INFO)
        log.addHandler(said)
        try:
            with (
                asked_first(bar.end) if endable and "MAKELEVEL" not in os.environ else nullcontext()
            ):
                yield bar
        finally:
            log.removeHandler(said)
            log.setLevel(level)
