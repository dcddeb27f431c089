"""Progress of a stage: completed steps, and the known total."""


class Ended(BaseException):
    """A person has ended a search."""


class Steps:
    """Receiver of a stage's progress; this one ignores it.

    A stage announces the steps `ahead` as soon as they are known, and calls the object after each
    step. The total may grow: the number of hypotheses to fit depends on the fits before. A subclass
    displays the progress, for example as a bar. Where `ended` is set, a search ends at its next
    step.

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

    ended = False

    def ahead(self, pieces: int) -> None:
        """Add steps to the known total."""

    def __call__(self) -> None:
        """Count one completed step."""

    def doing(self, what: str) -> None:
        """Take what the stage does from now on."""

    def say(self, sentence: str) -> None:
        """Take what a person should know before the stage is done."""


class Endable(Steps):
    """Steps that are passed on to another receiver, and raise `Ended` where it has been ended."""

    def __init__(self, shown: Steps) -> None:
        self._shown = shown
        self.ahead = shown.ahead  # type: ignore[method-assign]
        self.doing = shown.doing  # type: ignore[method-assign]
        self.say = shown.say  # type: ignore[method-assign]

    def __call__(self) -> None:
        """Count one completed step."""
        self._shown()
        if self._shown.ended:
            raise Ended


NO_PROGRESS = Steps()
