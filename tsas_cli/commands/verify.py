"""`tsas verify`: whether files are still what was recorded of them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, present
from tsas_cli.commands.progress import progress
from tsas_cli.support.errors import InputError


def verify(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A page, or a folder of what stages wrote.")
    ],
    raw: Annotated[
        list[Path] | None,
        typer.Option("--raw", metavar="DIR", help="Where raw recordings are that have moved."),
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Check every checksum from the report back to the raw recordings, and name what does not fit.

    It ends with exit code 2 where a file has changed or is missing. What nobody has recorded is
    told, but is no fault.
    """
    with progress("verify", quiet=quiet) as step:
        result = tsas.verify(path, raw=raw or (), step=step)
    present(result, quiet=quiet, as_json=as_json)
    sys.stdout.flush()
    if wrong := result.wrong:
        some = ", ".join(dict.fromkeys(one.file for one in wrong[:3]))
        more = f" and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        raise InputError(
            f"not what was recorded: {some}{more}",
            where=path,
            remedy="bring the files back, or run the stages that wrote or read them again",
        )
