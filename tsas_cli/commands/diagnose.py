"""`tsas diagnose`: the residuals, their cause, the extended model, the reduction."""

import typer

import tsas_cli as tsas
from tsas_cli.commands import common
from tsas_cli.support.stopping import EXIT_CODE


def diagnose(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    model: common.ModelOption = None,
    runs: common.ChosenRuns = None,
    despite: common.Despite = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Locate the residuals of the simulation, name their cause, and fit the extended model."""
    with (
        common.progress("diagnose", quiet=quiet, endable=True) as step,
        common.with_stream(rrd, step),
    ):
        result = tsas.diagnose(
            dataset,
            out=out,
            model=model,
            runs=common.names(runs),
            despite=despite or (),
            force=force,
            step=step,
        )
    common.present(result, quiet=quiet, as_json=as_json)
    if step.ended and result.verdict == "undecided":
        raise typer.Exit(EXIT_CODE)
