"""A progress bar on standard error, if it is a terminal, with the remaining time."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import TYPE_CHECKING

from tsas_cli.support.errors import printable
from tsas_cli.support.steps import NO_PROGRESS, Steps

if TYPE_CHECKING:
    from rich.progress import Progress


class Bar(Steps):
    """A progress bar, whose total grows with the announced steps."""

    def __init__(self, shown: "Progress", label: str) -> None:
        self.shown, self.total, self.done = shown, 0, 0
        self.task = shown.add_task(label, total=None, left="")

    def ahead(self, pieces: int) -> None:
        """Add steps to the total."""
        self.total += pieces
        self._show()

    def __call__(self) -> None:
        """Count one completed step."""
        self.done += 1
        self._show()

    def say(self, sentence: str) -> None:
        """Print a sentence above the bar."""
        self.shown.console.print(printable(sentence), markup=False, highlight=False)

    def _show(self) -> None:
        """Draw the bar, with the remaining time at the pace so far."""
        rest, left = self.total - self.done, ""
        if self.done and rest > 0:
            so_far_s = self.shown.tasks[0].elapsed or 0.0
            left = f"about {timedelta(seconds=round(so_far_s / self.done * rest))} left"
        self.shown.update(self.task, total=self.total or None, completed=self.done, left=left)


@contextmanager
def progress(label: str, *, quiet: bool) -> Iterator[Steps]:
    """Show a bar while a stage runs, unless it is quiet; yield the receiver of its steps."""
    if quiet or not sys.stderr.isatty():
        yield NO_PROGRESS
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(separator=" of "),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        yield Bar(shown, label)
