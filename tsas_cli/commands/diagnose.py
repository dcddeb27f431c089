"""`tsas diagnose`: the residuals, their cause, the extended model, the reduction."""

import tsas_cli as tsas
from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Despite,
    Force,
    Json,
    ModelOption,
    OutFolder,
    Quiet,
    Rrd,
    names,
    present,
    with_stream,
)
from tsas_cli.commands.progress import progress


def diagnose(
    dataset: DatasetFolder,
    out: OutFolder,
    model: ModelOption = None,
    runs: ChosenRuns = None,
    despite: Despite = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Locate the residuals of the simulation, name their cause, and fit the extended model."""
    with progress("diagnose", quiet=quiet) as step, with_stream(rrd, step):
        result = tsas.diagnose(
            dataset,
            out=out,
            model=model,
            runs=names(runs),
            despite=despite or (),
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)
