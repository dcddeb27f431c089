"""`tsas verify`: verify recorded checksums."""

import sys
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, present, progress
from tsas_cli.support.errors import InputError


def verify(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="A report, or a folder of outputs.")],
    raw: Annotated[
        list[Path] | None,
        typer.Option("--raw", metavar="DIR", help="A folder of raw recordings that have moved."),
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Verify every recorded checksum, from a report back to the raw recordings.

    The exit code is 2 if a file has changed or is missing. A file without a recorded checksum is
    listed, but is no fault.
    """
    with progress("verify", quiet=quiet) as step:
        result = tsas.verify(path, raw=raw or (), step=step)
    present(result, quiet=quiet, as_json=as_json)
    sys.stdout.flush()
    if wrong := result.wrong:
        some = ", ".join(dict.fromkeys(one.file for one in wrong[:3]))
        more = f" and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        raise InputError(
            f"changed or missing: {some}{more}",
            where=path,
            remedy="restore the files, or run the stages that wrote or read them again",
        )
