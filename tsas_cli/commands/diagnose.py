"""`tsas diagnose`: what the model gets wrong, its cause, the extended model, the gain."""

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


def diagnose(
    dataset: DatasetFolder,
    out: OutFolder,
    model: ModelFile = None,
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Show what the simulation gets wrong, name the cause, extend the model, measure the gain."""
    from tsas_cli.diagnosis.diagnose_stage import diagnose_dataset, tables

    data = opened(dataset, runs)
    with progress("diagnose", None, quiet=quiet or as_json) as step:
        summary = diagnose_dataset(data, model, out, force=force, step=step)
    if rrd:
        add_stream(out, quiet=quiet or as_json)
    show(summary, tables(summary, out), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        print(summary["reason"])
        print(f"Next: {summary['next_experiment']}")
        for sentence in summary["cannot_tell"]:
            print(f"- {sentence}")
