"""`tsas close-loop`: hide an effect in a rig, diagnose it, and track with the extended model."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands import common


def close_loop(
    out: common.OutFolder,
    cases: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Only these cases, comma-separated; default: all."),
    ] = None,
    hide: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Hide this effect instead of the built-in cases."),
    ] = None,
    settings: Annotated[
        Path | None,
        typer.Option(metavar="S.toml", help="Rig, drive, sensors, reference and gains."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Number of noise seeds.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="The first noise seed.")] = 1,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Compare tracking with the nominal, the extended and the true model of a rig."""
    with (
        common.progress("close-loop", quiet=quiet) as step,
        common.with_stream(rrd, step, _of_each_case),
    ):
        result = tsas.close_loop(
            out=out,
            cases=common.names(cases),
            hide=hide or (),
            settings=settings,
            seeds=seeds,
            first_seed=seed,
            force=force,
            step=step,
        )
    common.present(result, quiet=quiet, as_json=as_json)


def _of_each_case(folder: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Yield each case's folder, and the folders that its stream shows."""
    from tsas_cli.records.closing import ClosingFile
    from tsas_cli.reporting.inputs import read_stage

    for case in read_stage(ClosingFile, folder).cases:
        home = folder / case.case
        shown = (home / name for name in ("dataset", "calibrate", "diagnose", "identify"))
        yield home, [path for path in shown if path.is_dir()]
