"""Setting up: `tsas init` creates a project, `tsas doctor` checks the installation."""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tsas_cli.commands.common import Json, Quiet, printed, progress, show
from tsas_cli.records.result import Table, heading
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError, printable

if TYPE_CHECKING:
    from tsas_cli.installation.packages import Extra


def init(
    named: Annotated[
        str, typer.Argument(metavar="FOLDER", help="The project's folder; nothing is overwritten.")
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
    from tsas_cli.recordings.guess.text import tables as tables_of

    if not named:  # as of an unset variable of the shell; its path would be the current folder
        raise InputError(
            "no folder is named", expected="a folder's name", remedy="`tsas init .` takes this one"
        )
    folder = Path(named)
    files, proposal = start(folder, sources or [])
    questions = proposal.questions if proposal else {}
    summary = heading("init") | {"folder": str(folder), "files": files, "questions": questions}
    tables: list[Table] = [(f"project {folder}", ("file",), [(name,) for name in files])]
    if proposal:
        tables.extend(tables_of(proposal, folder / MAP))
    todo = questions or not proposal
    first = f"answer the questions in {folder / MAP}, then " if todo else ""
    following = printable(f"Next: {first}`make -C {shlex.quote(str(folder))}`")
    with printed(folder):
        show(summary, tables, [following], quiet=quiet, as_json=as_json)


def doctor(quiet: Quiet = False, as_json: Json = False) -> None:
    """Check the installation, and print the command that installs what is missing.

    The exit code is 2 if a required package is missing; anything else is only reported.
    """
    try:
        from tsas_cli.installation.packages import core_packages, extras
    except ModuleNotFoundError as error:
        raise InputError(f"{error.name} is missing", remedy=_pip([str(error.name)])) from error
    from tsas_cli.installation.machine import abilities

    with progress("looking", quiet=quiet):
        core, more, machine = list(core_packages()), extras(), list(abilities())
    python = sys.version.split()[0]
    summary = heading("doctor") | {
        "python": {"version": python, "program": sys.executable},
        "packages": [asdict(package) for package in core],
        "extras": [
            asdict(extra) | {"missing": extra.missing, "install": _install(extra)} for extra in more
        ],
        "machine": [asdict(ability) for ability in machine],
    }
    tables = [
        (
            f"tsas {__version__} on Python {python}, {sys.executable}",
            ("package", "required", "found", "state"),
            [(p.name, p.asked, p.found or "", p.problem or "installed") for p in core],
        ),
        (
            "extras",
            ("extra", "for", "missing", "install it with"),
            [(e.name, e.purpose, ", ".join(e.missing) or "none", _install(e)) for e in more],
        ),
        (
            "this machine",
            ("capability", "available", "found", "remedy"),
            [(a.name, "yes" if a.works else "no", a.found, a.remedy) for a in machine],
        ),
    ]
    show(summary, tables, quiet=quiet, as_json=as_json)
    sys.stdout.flush()
    if wrong := [package for package in core if package.problem]:
        problems = ", ".join(
            f"{p.name} {p.found or ''} {p.problem}".replace("  ", " ") for p in wrong
        )
        required = [f"{p.name}{p.asked}" for p in wrong if p.name != "Python"]
        remedy = _pip(required) if required else f"use Python {wrong[0].asked}"
        raise InputError(f"required packages are missing or wrong: {problems}", remedy=remedy)


def _install(extra: "Extra") -> str:
    return _pip([f"tsas[{extra.name}]"]) if extra.missing else ""


def _pip(requirements: Sequence[str]) -> str:
    return shlex.join([sys.executable, "-m", "pip", "install", *requirements])
