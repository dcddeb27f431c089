"""`tsas init`: create a project, from recordings to a report by `make`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Json, Quiet, show
from tsas_cli.support import __version__
from tsas_cli.support.errors import printable


def init(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="The project's folder; nothing is overwritten.")
    ],
    sources: Annotated[
        list[Path] | None,
        typer.Option(
            "--from", metavar="SOURCE", help="Recordings to copy and to propose a map for."
        ),
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Create a project: a map, a folder for recordings, and a Makefile from them to a report."""
    from tsas_cli.project.start import MAP, start

    files, proposal = start(folder, sources or [])
    questions = proposal.questions if proposal else {}
    summary = {
        "format": 1,
        "stage": "init",
        "version": __version__,
        "folder": str(folder),
        "files": files,
        "questions": questions,
    }
    tables = [(f"project {folder}", ("file",), [(name,) for name in files])]
    show(summary, tables, quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        todo = questions or not proposal
        first = f"answer the questions in {folder / MAP}, then " if todo else ""
        print(printable(f"Next: {first}`make -C {shlex.quote(str(folder))}`"))
