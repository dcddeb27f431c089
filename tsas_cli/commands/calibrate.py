"""`tsas calibrate`: phases, stiffness per phase, and the joint fit of the nominal model."""

from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    OutFolder,
    Quiet,
    opened,
    progress,
    show,
)


def calibrate(
    dataset: DatasetFolder,
    out: OutFolder,
    runs: ChosenRuns = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Fit the nominal model to a dataset, and the stiffness km of each phase."""
    from tsas_cli.identification.calibrate_stage import calibrate_dataset, tables

    data = opened(dataset, runs)
    with progress("calibrate", 2 * len(data.runs), quiet=quiet or as_json) as step:
        summary = calibrate_dataset(data, out, force=force, step=step)
    show(summary, tables(summary, out), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["cannot_tell"]:
            print(f"- {sentence}")
