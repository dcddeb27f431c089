"""`tsas ingest`: from a person's files to a dataset."""

from pathlib import Path
from typing import Annotated

import typer

from tsas_cli import __version__
from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, progress, show


def ingest(
    sources: Annotated[
        list[Path], typer.Argument(metavar="SOURCE", help="Files, or folders to search.")
    ],
    map_path: Annotated[Path, typer.Option("--map", metavar="MAP.toml", help="What they hold.")],
    out: OutFolder,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Turn files of a rig into a dataset, as a map says (docs/ingest.md shows one)."""
    from tsas_cli.files import new_folder
    from tsas_cli.recordings.ingest import find_files, ingest_files
    from tsas_cli.recordings.ingest_map import read_map

    mapping = read_map(map_path)
    files = find_files(sources, mapping.read.files)
    with (
        new_folder(out, force=force) as folder,
        progress("ingest", len(files), quiet=quiet) as step,
    ):
        runs = ingest_files(files, mapping, map_path, folder, step=step)
    summary = {
        "format": 1,
        "stage": "ingest",
        "version": __version__,
        "dataset": {"name": mapping.dataset.name, "folder": str(out)},
        "runs": [vars(run) | {"source": str(run.source)} for run in runs],
    }
    header = ("run", "rows", "duration", "rate", "columns")
    rows = [
        (r.run, f"{r.rows}", f"{r.duration_s:.6g} s", f"{r.rate_Hz:.6g} Hz", " ".join(r.columns))
        for r in runs
    ]
    show(summary, [(f"dataset {out}", header, rows)], quiet=quiet, as_json=as_json)
