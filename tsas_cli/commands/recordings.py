"""Recordings: `tsas ingest`, `check`, `runs`, `upload` and `verify`."""

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands import common, completion
from tsas_cli.support.errors import InputError


def ingest(
    sources: Annotated[
        list[Path], typer.Argument(metavar="SOURCE", help="Files, or folders to search.")
    ],
    map_path: Annotated[
        Path | None, typer.Option("--map", metavar="MAP.toml", help="The map of their columns.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="The folder to write; with --guess, the map to write."
        ),
    ] = None,
    guess: Annotated[
        bool, typer.Option("--guess", help="Propose a map, to standard output or --out.")
    ] = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Convert raw files to a dataset by a map, or propose the map (docs/ingest.md)."""
    if guess:
        if map_path is not None:
            raise InputError(
                "--guess proposes a map, --map uses one", remedy="leave one of them out"
            )
        common.present(tsas.guess(sources, out=out, force=force), quiet=quiet, as_json=as_json)
    elif map_path is None or out is None:
        source = shlex.quote(str(sources[0]))
        raise InputError(
            f"--{'out' if map_path else 'map'} is missing",
            expected="--map MAP.toml --out DATASET",
            remedy=f"`tsas ingest {source} --guess --out MAP.toml` proposes a map",
        )
    else:
        shown = {"quiet": quiet, "as_json": as_json}
        common.run(tsas.ingest, sources=sources, map=map_path, out=out, force=force, **shown)


def check(
    dataset: common.DatasetFolder,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/check.json.")
    ] = None,
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Check recordings for faults before a model is fitted."""
    if rrd and out is None:
        raise InputError("--rrd has no folder to write to", remedy="set --out")
    common.run(tsas.check, **locals())


def runs(
    query: Annotated[
        str, typer.Argument(metavar="QUERY", help="A condition in SQL; default: all runs.")
    ] = "",
    folders: Annotated[
        list[Path] | None,
        typer.Option("--in", metavar="DIR", help="A folder to search; repeatable; default: here."),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns to print, comma-separated.",
            autocompletion=completion.run_columns,
            callback=common.names,
        ),
    ] = None,
    sort: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns to sort by; -NAME: descending.",
            autocompletion=completion.sort_columns,
            callback=common.names,
        ),
    ] = None,
    limit: Annotated[int | None, typer.Option(min=0, help="Largest number of runs.")] = None,
    paths: Annotated[
        bool, typer.Option("--paths", help="Print only the datasets' folders, one per line.")
    ] = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Find runs in all datasets below a folder, by conditions, channels and verdicts.

    For example: tsas runs 'total_bend_rad > 3 and f_out in channels and started >= 2026-01'
    """
    if paths and as_json:
        raise InputError("--paths and --json are two outputs", remedy="leave one out")
    with common.progress("runs", quiet=quiet) as step:
        found = tsas.runs(
            query, folders or ".", columns=columns or (), sort=sort or (), limit=limit, step=step
        )
    if not paths:
        common.present(found, quiet=quiet, as_json=as_json)
    elif not quiet:
        print(*found.paths, sep="\n", end="\n" if found.paths else "")


def upload(
    folder: Annotated[Path, typer.Argument(metavar="DATASET", help="A dataset's local folder.")],
    address: Annotated[
        str, typer.Argument(metavar="ADDRESS", help="The target: s3://BUCKET/PATH or gs://….")
    ],
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Copy a dataset to object storage, where every command reads it by its address."""
    common.run(tsas.upload, **locals())


def verify(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="A report, or a folder of outputs.")],
    raw: Annotated[
        list[Path] | None,
        typer.Option("--raw", metavar="DIR", help="A folder of raw recordings that have moved."),
    ] = None,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Verify every recorded checksum, from a report back to the raw recordings.

    The exit code is 2 if a file has changed or is missing. A file without a recorded checksum is
    listed, but is no fault.
    """
    result = common.run(tsas.verify, **locals())
    sys.stdout.flush()
    if wrong := result.wrong:
        some = ", ".join(dict.fromkeys(one.file for one in wrong[:3]))
        more = f" and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        raise InputError(
            f"changed or missing: {some}{more}",
            where=path,
            remedy="restore the files, or run the stages that wrote or read them again",
        )
