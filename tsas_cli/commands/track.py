"""`tsas track`: close the loop on a simulated rig and say how well a wanted force is followed."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from tsas_cli.commands.common import (
    Force,
    Json,
    OutFolder,
    Quiet,
    Rrd,
    add_stream,
    progress,
    show,
)


class TendonOption(StrEnum):
    """The models of the plant's tendon; the controller's own is the slip chain."""

    slip = "slip"
    lugre = "lugre"


COLUMNS = (
    ("RMSE [N]", "rmse_N"),
    ("lowest [N]", "lowest_error_N"),
    ("highest [N]", "highest_error_N"),
    ("effort [rpm]", "effort_rpm"),
    ("chatter [rpm/s]", "chatter_rpm_per_s"),
    ("outside 2 % [%]", "outside_percent"),
)


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
        typer.Option(metavar="NAMES", help="One or several, with commas between, or all."),
    ] = "adaptive-sliding-mode",
    compare: Annotated[
        bool,
        typer.Option("--compare", help="All controllers, with and without disturbance, 10 seeds."),
    ] = False,
    reference: Annotated[
        str,
        typer.Option(help="sine, two-frequency, steps, ramps, or a Parquet file (f_out_ref_N)."),
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
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Follow a wanted force with a controller that sees x_in alone."""
    from tsas_cli.tracking.conditions import Condition, disturbed, proximal_spring
    from tsas_cli.tracking.settings import CONTROLLERS
    from tsas_cli.tracking.track_stage import Call, track_all

    named = tuple(dict.fromkeys(name.strip() for name in controller.split(",")))
    names = CONTROLLERS if compare or controller == "all" else named
    conditions = [disturbed(disturb)] if disturb else []
    if compare:
        conditions = [Condition("undisturbed"), *(conditions or [proximal_spring()])]
    call = Call(
        model=model,
        plant=plant,
        drive=drive,
        settings=settings,
        controllers=names,
        conditions=tuple(conditions) or (Condition("undisturbed"),),
        reference=reference,
        as_printed=as_printed,
        dynamics=dynamics.value,
        seeds=seeds or (10 if compare else 1),
        first_seed=seed,
    )
    total = len(call.controllers) * len(call.conditions) * call.seeds
    with progress("track", total, quiet=quiet or as_json) as step:
        summary = track_all(call, out, force=force, step=step)
    if rrd:
        add_stream(out, quiet=quiet or as_json)
    header = ["controller", "condition", *(title for title, _ in COLUMNS)]
    rows = [
        [row["controller"], row["condition"], *(_cell(row["scores"][key]) for _, key in COLUMNS)]
        for row in summary["results"]
    ]
    printed = [row["printed_rmse_N"] for row in summary["results"]]
    if any(value is not None for value in printed):
        header.insert(3, "Table 5 [N]")
        for row, value in zip(rows, printed, strict=True):
            row.insert(3, "" if value is None else f"{value:g}")
    show(summary, [(f"tracking → {out}", header, rows)], quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["notes"]:
            print(f"- {sentence}")


def _cell(number: dict[str, Any]) -> str:
    spread = number["sd"]
    return f"{number['mean']:.4g}" + ("" if spread is None else f" ± {spread:.2g}")
