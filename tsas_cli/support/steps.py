"""Progress of a stage: completed steps, and the known total."""


class Steps:
    """Receiver of a stage's progress; this one ignores it.

    A stage announces the steps `ahead` as soon as they are known, and calls the object after each
    step. The total may grow: the number of hypotheses to fit depends on the fits before. A subclass
    displays the progress, for example as a bar.

    >>> class Counted(Steps):
    ...     total = done = 0
    ...     def ahead(self, pieces):
    ...         self.total += pieces
    ...     def __call__(self):
    ...         self.done += 1
    >>> steps = Counted()
    >>> steps.ahead(2)
    >>> steps()
    >>> f"{steps.done} of {steps.total}"
    '1 of 2'
    """

    def ahead(self, pieces: int) -> None:
        """Add steps to the known total."""

    def __call__(self) -> None:
        """Count one completed step."""

    def say(self, sentence: str) -> None:
        """Take what a person should know before the stage is done."""


NO_PROGRESS = Steps()
