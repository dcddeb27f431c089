"""`tsas simulate`: simulate the recorded runs with a model."""

from functools import partial
from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands import common


def simulate(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    model: common.ModelOption = None,
    dynamics: Annotated[
        Literal["static", "slip", "lugre"],
        typer.Option(
            "--dynamics",
            help="static: of the paper; slip: distributed friction; lugre: dynamic friction.",
        ),
    ] = "slip",
    fit_own: Annotated[
        bool,
        typer.Option(help="First fit the preload and zeros of each run."),
    ] = False,
    nodes: Annotated[
        int | None,
        typer.Option(help="Nodes of the chain, 2 to 1000."),
    ] = None,
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    live: common.Live = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Simulate every run with a model, and compute its residual."""
    data = tsas.read(dataset, runs=common.names(runs))
    with common.watched(live, f"{data.manifest.name} · simulation", quiet=quiet) as stream:
        with common.progress("simulate", quiet=quiet) as step, common.with_stream(rrd, step):
            result = tsas.simulate(
                data,
                out=out,
                model=model,
                dynamics=dynamics,
                fit_own=fit_own,
                nodes=nodes,
                force=force,
                step=step,
                each=partial(stream.simulated, data) if stream else common.not_shown,
            )
        common.present(result, quiet=quiet, as_json=as_json)
