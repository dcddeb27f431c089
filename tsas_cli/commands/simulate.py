"""`tsas simulate`: run a model on the recorded inputs and compare."""

from enum import StrEnum
from typing import Annotated

import typer

from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    ModelFile,
    OutFolder,
    Quiet,
    Rrd,
    add_stream,
    opened,
    progress,
    show,
)


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
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Simulate every run with a model and say how far it is from the measurement."""
    from tsas_cli.identification.simulation import simulate_dataset

    data = opened(dataset, runs)
    with progress("simulate", len(data.runs), quiet=quiet or as_json) as step:
        summary = simulate_dataset(
            data,
            model,
            dynamics.value,
            out,
            fit_own=fit_own,
            nodes=nodes,
            force=force,
            step=step,
        )
    if rrd:
        add_stream(out, quiet=quiet or as_json)
    rows = [
        (run, name, f"{c['rmse']:.4g}", f"{c['noise']:.2g}", c["unit"], answer["solver"])
        for run, answer in summary["runs"].items()
        for name, c in answer["channels"].items()
    ]
    header = ("run", "channel", "RMSE", "noise", "unit", "solver")
    show(summary, [(f"{dynamics.value} model → {out}", header, rows)], quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["notes"]:
            print(f"- {sentence}")
