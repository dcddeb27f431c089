"""`tsas upload DATASET ADDRESS`: copy a dataset to object storage."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress


def upload(
    folder: Annotated[Path, typer.Argument(metavar="DATASET", help="A dataset's local folder.")],
    address: Annotated[
        str, typer.Argument(metavar="ADDRESS", help="The target: s3://BUCKET/PATH or gs://….")
    ],
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Copy a dataset to object storage, where every command reads it by its address."""
    with progress("upload", quiet=quiet) as step:
        result = tsas.upload(folder, address, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
