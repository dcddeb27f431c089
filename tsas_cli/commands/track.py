"""`tsas track`: closed-loop force tracking on a simulated rig."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands import common, completion


def track(
    out: common.OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="The controller's model; default: the paper's rig."),
    ] = None,
    plant: Annotated[
        Path | None, typer.Option(metavar="P.toml", help="The simulated rig; default: as --model.")
    ] = None,
    drive: Annotated[
        Path | None,
        typer.Option(metavar="D.toml", help="The controller's drive model; default: r1, im."),
    ] = None,
    controllers: Annotated[
        str,
        typer.Option(
            "--controller",
            metavar="NAMES",
            help="Names, comma-separated, or all.",
            autocompletion=completion.controllers,
            callback=common.names,
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
            autocompletion=completion.references,
        ),
    ] = "sine",
    disturb: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE[@S]", help="Change the plant, from S seconds on."),
    ] = None,
    as_printed: Annotated[
        bool,
        typer.Option(help="Gain ks of the sliding modes per mm, as printed in the paper: a relay."),
    ] = False,
    dynamics: Annotated[
        Literal["slip", "lugre"],
        typer.Option(help="Friction of the plant: slip, quasi-static; lugre, dynamic."),
    ] = "slip",
    settings: Annotated[
        Path | None,
        typer.Option(metavar="S.toml", help="Rig, drive, sensors, reference and gains."),
    ] = None,
    seeds: Annotated[int | None, typer.Option(min=1, help="Number of noise seeds.")] = None,
    first_seed: Annotated[int, typer.Option("--seed", min=0, help="The first noise seed.")] = 1,
    rrd: common.Rrd = False,
    live: common.Live = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Track a reference of the distal tension with controllers that measure x_in only."""
    given = locals()
    with common.watched(given.pop("live"), "tracking", quiet=quiet) as stream:
        common.run(tsas.track, **given, each=stream.tracked if stream else None)
