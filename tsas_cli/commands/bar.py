"""The progress bar of a command."""

import logging
from datetime import timedelta
from typing import TYPE_CHECKING

from tsas_cli.support.errors import printable
from tsas_cli.support.steps import Steps

if TYPE_CHECKING:
    from rich.progress import Progress

ENDS = (
    "Ctrl-C: the search ends after this step, and what it has found is written; "
    "Ctrl-C again stops at once and writes nothing"
)


class Bar(Steps, logging.Handler):
    """A progress bar, whose total grows with the announced steps; above it stands what is logged.

    The remaining time is that of the steps that were announced together, at their pace: those
    before may have been of another kind.
    """

    def __init__(self, shown: "Progress", label: str) -> None:
        logging.Handler.__init__(self)
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

    def emit(self, record: logging.LogRecord) -> None:
        """Print what the package logs."""
        self.say(record.getMessage())

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
