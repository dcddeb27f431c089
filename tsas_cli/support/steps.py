"""How far a stage has come: the pieces of work that are done, and those that are known to come."""


class Steps:
    """What a stage tells of its progress; this one listens to nothing.

    A stage says what lies `ahead` as soon as it knows it, and calls the object after each piece of
    work. What lies ahead may grow: how many hypotheses there are to fit is known after those
    before them. A subclass shows it, for example with a bar.

    Examples
    --------
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
        """Take note of so many more pieces of work that are known to come."""

    def __call__(self) -> None:
        """Take note that a piece of work is done."""


SILENT = Steps()
