"""Models: `tsas calibrate`, `identify-harmonic-drive`, `simulate`, `diagnose` and the others."""

from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands import common
from tsas_cli.support.errors import InputError


def calibrate(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="The initial model, whose effects are kept."),
    ] = None,
    dynamics: Annotated[
        Literal["slip", "lugre"],
        typer.Option(help="slip: distributed friction; lugre: dynamic friction."),
    ] = "slip",
    runs: common.ChosenRuns = None,
    despite: common.Despite = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Fit the nominal model and the stiffness km of each phase to a dataset."""
    common.run(tsas.calibrate, **locals())


def identify_harmonic_drive(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    speed: Annotated[
        Literal["measured", "commanded"],
        typer.Option(
            help="measured: linear between samples; commanded: zero-order hold, as from a "
            "controller. The wrong choice is a delay of half a sample.",
        ),
    ] = "measured",
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Identify the drive from motor speed to x_in, diagnose it, and compute its feedforward."""
    common.run(tsas.identify_harmonic_drive, **locals())


def simulate(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    model: common.ModelOption = None,
    dynamics: Annotated[
        Literal["static", "slip", "lugre"],
        typer.Option(
            help="static: of the paper; slip: distributed friction; lugre: dynamic friction.",
        ),
    ] = "slip",
    fit_own: Annotated[
        bool, typer.Option(help="First fit the preload and zeros of each run.")
    ] = False,
    nodes: Annotated[int | None, typer.Option(help="Nodes of the chain, 2 to 1000.")] = None,
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    live: common.Live = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Simulate every run with a model, and compute its residual."""
    given = locals()
    data = tsas.read(given.pop("dataset"), runs=given.pop("runs"))
    name = f"{data.manifest.name} · simulation"
    with common.watched(given.pop("live"), name, quiet=quiet) as stream:
        each = partial(stream.simulated, data) if stream else None
        common.run(tsas.simulate, dataset=data, each=each, **given)


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
    common.run(tsas.diagnose, endable=True, **locals())


def predict(
    given: Annotated[
        list[str],
        typer.Argument(
            metavar="MODEL… DATASET",
            help="Models, or outputs of `tsas calibrate` or `diagnose`; then the dataset.",
        ),
    ],
    runs: common.ChosenRuns = None,
    fit_own: Annotated[
        bool,
        typer.Option(
            "--fit-own/--as-is",
            help="First fit the preload and zeros of each run, or fit nothing to it.",
        ),
    ] = True,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Also write DIR/predict.json and DIR/runs/.")
    ] = None,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Predict recordings with models that were fitted to others, and say whether that carries over.

    Each model is simulated on every run of DATASET and held to what was measured. A run whose
    conditions or signals leave what a model was fitted to is outside the model's range.
    """
    options = locals()
    *models, dataset = options.pop("given")
    if not models:
        raise InputError(
            "one argument alone", where=dataset, expected="MODEL… DATASET, the dataset last"
        )
    common.run(tsas.predict, models=models, dataset=dataset, **options)


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A model, or a stage's folder.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="The other model or folder.")],
    on: Annotated[
        str | None,
        typer.Option(metavar="DATASET", help="Simulate both models on these recordings."),
    ] = None,
    runs: common.ChosenRuns = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Also write DIR/compare.json and DIR/report.html."),
    ] = None,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Compare two models or results, and test whether they differ by more than the uncertainty.

    A and B are model files, or outputs of `tsas calibrate`, `diagnose`, `simulate` or `track`.
    """
    common.run(tsas.compare, **locals())


def plan(
    path: Annotated[
        str, typer.Argument(metavar="DATASET|RIG.toml", help="A dataset, or planned runs.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/plan.json.")
    ] = None,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Compute the smallest detectable size of each effect, and the most useful further run."""
    common.run(tsas.plan, runs=path, out=out, force=force, quiet=quiet, as_json=as_json)


def export(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="A model file, or its folder.")],
    to: Annotated[str, typer.Option(metavar="FORMAT", help="json, csv or mujoco (MJCF).")],
    out: Annotated[Path, typer.Option(metavar="FILE", help="The file to write.")],
    sheath_length_mm: Annotated[
        float | None, typer.Option(help="Of a MuJoCo model; default: that of the recordings.")
    ] = None,
    total_bend_rad: Annotated[float | None, typer.Option(help="Likewise.")] = None,
    preload_n: Annotated[float | None, typer.Option("--preload-N", help="Likewise.")] = None,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Write a model as JSON, CSV, or a MuJoCo model; what that cannot hold is said."""
    with common.progress("export", quiet=quiet):
        result = tsas.export(
            model,
            to=to,
            out=out,
            sheath_length_mm=sheath_length_mm,
            total_bend_rad=total_bend_rad,
            preload_N=preload_n,
            force=force,
        )
    common.present(result, quiet=quiet, as_json=as_json)
