"""What a diagnosis is worth in tracking: hidden differences, named, and tracked with each model."""

from tsas_cli.records.closing import ClosedCase, ClosingFile, Named
from tsas_cli.reporting.closing import errors
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import as_printed

_HOW = (
    "A plant differs from what the controller knows. It is recorded while it tracks with the model "
    "of the data sheet, calibrated and diagnosed from these recordings alone, and tracks a "
    "reference with four models in inverse and feedforward."
)
_SHARED = (
    "All is simulated, and the plant is made of the same laws as the models: a wrong law would go "
    "unseen here. The blind benchmark has a rig of its own for that."
)
_LIMIT = (
    "The limit is the plant's own model. It is no lower bound: a wrong model may happen to cancel "
    "a part of what the controller itself leaves, so that extended / true can be below 1. Where "
    "nothing is named, the extended model is the calibrated one."
)


def section(inputs: Inputs) -> Section | None:
    """Return the section, None where no loop was closed over a diagnosis."""
    closing = inputs.get(ClosingFile)
    if closing is None:
        return None
    return Section(
        "closing",
        "Does a better model track better?",
        (_HOW, _SHARED),
        tables=(_hidden_and_named(closing),),
        parts=(
            Section(
                "closing-rmse",
                "RMSE by model",
                (_LIMIT,),
                points=tuple(errors.worth(closing)),
                pictures=(errors.dots(closing),),
            ),
            Section("closing-table", "The same errors in numbers", tables=(errors.table(closing),)),
        ),
    )


def _hidden_and_named(closing: ClosingFile) -> Table:
    """Return the _hidden_and_named, one row for each case."""
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
