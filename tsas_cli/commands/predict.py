"""`tsas predict`: predict recordings with models that were fitted to others."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import ChosenRuns, Force, Json, Quiet, names, present, progress


def predict(
    given: Annotated[
        list[str],
        typer.Argument(
            metavar="MODEL… DATASET",
            help="Models, or outputs of `tsas calibrate` or `diagnose`; then the dataset.",
        ),
    ],
    runs: ChosenRuns = None,
    fit_own: Annotated[
        bool,
        typer.Option(
            "--fit-own/--as-is",
            help="First fit the preload and zeros of each run, or fit nothing to it.",
        ),
    ] = True,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Also write DIR/predict.json and DIR/runs/."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Predict recordings with models that were fitted to others, and say whether that carries over.

    Each model is simulated on every run of DATASET and held to what was measured. A run whose
    conditions or signals leave what a model was fitted to is outside the model's range.
    """
    *models, dataset = given
    if not models:
        raise tsas.InputError(
            "one argument alone", where=dataset, expected="MODEL… DATASET, the dataset last"
        )
    with progress("predict", quiet=quiet) as step:
        result = tsas.predict(
            models, dataset, out=out, runs=names(runs), fit_own=fit_own, force=force, step=step
        )
    present(result, quiet=quiet, as_json=as_json)
