"""`tsas simulate`: run a model on the recorded inputs and compare."""

from enum import StrEnum
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    ModelFile,
    OutFolder,
    Quiet,
    names,
    present,
)
from tsas_cli.commands.progress import progress


class DynamicsOption(StrEnum):
    """The models of the tendon that can be simulated."""

    static = "static"
    slip = "slip"
    lugre = "lugre"


def simulate(
    dataset: DatasetFolder,
    out: OutFolder,
    model: ModelFile = None,
    dynamics: Annotated[
        DynamicsOption,
        typer.Option("--dynamics", help="static: the paper's; slip: distributed; lugre: dynamic."),
    ] = DynamicsOption.slip,
    fit_own: Annotated[
        bool,
        typer.Option(help="Fit what belongs to each run alone first: its preload and its zeros."),
    ] = False,
    nodes: Annotated[
        int | None,
        typer.Option(help="Nodes of the chain, 2 to 1000, where not as usual."),
    ] = None,
    runs: ChosenRuns = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Simulate every run with a model and say how far it is from the measurement."""
    with progress("simulate", quiet=quiet) as step:
        result = tsas.simulate(
            dataset,
            out=out,
            model=model,
            dynamics=dynamics.value,
            fit_own=fit_own,
            nodes=nodes,
            runs=names(runs),
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)
