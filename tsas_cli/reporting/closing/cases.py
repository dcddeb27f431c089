"""What was hidden in the plant, and what the diagnosis named."""

from tsas_cli.records.closing import ClosedCase, ClosingFile, Named
from tsas_cli.reporting.content import Table
from tsas_cli.reporting.numbers import as_printed


def table(closing: ClosingFile) -> Table:
    """Return the table, one row for each case."""
    rows = tuple(
        (case.case, case.title, _hidden(case), case.verdict, _named(case.named))
        for case in closing.cases
    )
    header = ("case", "what differs", "hidden", "verdict", "named")
    return Table("What was hidden in the plant, and what the diagnosis named", header, rows)


def _hidden(case: ClosedCase) -> str:
    return ", ".join(f"`{name}` = {as_printed(value)}" for name, value in case.hidden.items())


def _named(named: tuple[Named, ...]) -> str:
    causes = (" or ".join(f"`{name}`" for name in (it.effect, *it.rivals)) for it in named)
    return ", ".join(causes) or "nothing"
