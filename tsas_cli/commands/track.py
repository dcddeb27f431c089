"""`tsas track`: close the loop on a simulated rig and say how well a wanted force is followed."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import (
    Force,
    Json,
    OutFolder,
    Quiet,
    Rrd,
    names,
    present,
    with_stream,
)
from tsas_cli.commands.completion import controllers, references
from tsas_cli.commands.live import Live, unseen, watched
from tsas_cli.commands.progress import progress


class TendonOption(StrEnum):
    """The models of the plant's tendon; the controller's own is the slip chain."""

    slip = "slip"
    lugre = "lugre"


def track(
    out: OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="What the controller knows; else the paper's rig."),
    ] = None,
    plant: Annotated[
        Path | None,
        typer.Option(metavar="P.toml", help="What it acts on; else the same as --model."),
    ] = None,
    drive: Annotated[
        Path | None,
        typer.Option(metavar="D.toml", help="What the controller knows of the drive; else r1, im."),
    ] = None,
    controller: Annotated[
        str,
        typer.Option(
            metavar="NAMES",
            help="One or several, with commas between, or all.",
            autocompletion=controllers,
        ),
    ] = "adaptive-sliding-mode",
    compare: Annotated[
        bool,
        typer.Option("--compare", help="All controllers, with and without disturbance, 10 seeds."),
    ] = False,
    reference: Annotated[
        str,
        typer.Option(
            help="sine, two-frequency, steps, ramps, or a Parquet file (f_out_ref_N).",
            autocompletion=references,
        ),
    ] = "sine",
    disturb: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE[@S]", help="Change the plant, from S seconds on."),
    ] = None,
    as_printed: Annotated[
        bool,
        typer.Option(help="ks of the sliding modes per mm as the paper prints it: a relay."),
    ] = False,
    dynamics: Annotated[
        TendonOption,
        typer.Option("--dynamics", help="The plant's tendon; slip: quasi-static; lugre: dynamic."),
    ] = TendonOption.slip,
    settings: Annotated[
        Path | None,
        typer.Option(metavar="S.toml", help="Rig, drive, sensors, reference and gains."),
    ] = None,
    seeds: Annotated[int | None, typer.Option(min=1, help="How many seeds of noise.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="The first of them.")] = 1,
    rrd: Rrd = False,
    live: Live = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Follow a wanted force with a controller that sees x_in alone."""
    with watched(live, "tracking", quiet=quiet) as stream:
        with progress("track", quiet=quiet) as step, with_stream(rrd, step):
            result = tsas.track(
                out=out,
                model=model,
                plant=plant,
                drive=drive,
                controllers=names(controller) or (),
                compare=compare,
                reference=reference,
                disturb=disturb or (),
                as_printed=as_printed,
                dynamics=dynamics.value,
                settings=settings,
                seeds=seeds,
                first_seed=seed,
                force=force,
                step=step,
                each=stream.tracked if stream else unseen,
            )
        present(result, quiet=quiet, as_json=as_json)
