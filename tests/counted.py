"""A listener to the steps of a stage."""

from tsas_cli.support.steps import Steps


class Counted(Steps):
    """Counts pieces of work, and whether more are ever done than were known to come."""

    def __init__(self) -> None:
        self.total, self.done, self.over = 0, 0, False

    def ahead(self, pieces: int) -> None:
        self.total += pieces

    def __call__(self) -> None:
        self.done += 1
        self.over |= self.done > self.total

    def all_of(self, least: int) -> bool:
        """Say whether all that was known to come is done, and that is no less than so much."""
        return self.done == self.total >= least and not self.over
