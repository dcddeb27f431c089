"""What a diagnosis is worth in tracking: hidden differences, named, and tracked with each model."""

from tsas_cli.records.closing import ClosingFile
from tsas_cli.reporting.closing import cases, errors
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.inputs import Inputs

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
        tables=(cases.table(closing),),
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
