"""`tsas sweep`: run a stage for many datasets or values, in processes or on a cluster."""

import sys
import tomllib
from pathlib import Path
from typing import Annotated, Any

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, OutFolder, Quiet, run
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.wording import count_of

WRONG, DEFECT = 2, 1  # exit codes


def sweep(
    what: Annotated[
        str,
        typer.Argument(
            metavar="PLAN|STAGE", help="A plan, or: check, calibrate, simulate, diagnose, track."
        ),
    ],
    datasets: Annotated[
        list[str] | None,
        typer.Argument(metavar="[DATASET]...", help="For a stage: folders, or patterns."),
    ] = None,
    *,
    out: OutFolder,
    options: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="An option of the stage, as in a plan."),
    ] = None,
    each_run: Annotated[
        bool, typer.Option("--each-run", help="One task per run instead of per dataset.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Number of processes; default: one per core.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler, to use its workers.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Repeat completed tasks.")] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Run a stage for many datasets or values, and collect the results in one table.

    Completed tasks are kept: the same call again runs only pending or changed ones.
    """
    result = run(
        tsas.sweep,
        plan=_plan(what, datasets or [], options or [], each_run=each_run),
        out=out,
        workers=workers,
        cluster=cluster,
        force=force,
        quiet=quiet,
        as_json=as_json,
    )
    if result.failed:
        line = f"tsas: {out}: {count_of(len(result.failed), 'task')} failed, as sweep.json says"
        print(printable(f"{line}; repeat the call to run them again"), file=sys.stderr)
        raise typer.Exit(DEFECT if result.defects else WRONG)


def _plan(
    what: str, datasets: list[str], options: list[str], *, each_run: bool
) -> Path | dict[str, object]:
    """Return the plan's file, or the content of the plan that the call describes."""
    if what.endswith(".toml"):
        if datasets or options or each_run:
            raise InputError(
                "a plan has no further arguments", where=what, remedy="set them in the plan"
            )
        return Path(what)
    named = dict(_option(option) for option in options)
    plan: dict[str, object] = {"stage": what, "each_run": each_run, "options": named}
    return plan | ({"datasets": datasets} if datasets else {})


def _option(text: str) -> tuple[str, Any]:
    """Return name and value; a value is in TOML, or text without quotes."""
    name, sign, value = text.partition("=")
    if not sign:
        raise InputError(f"{text!r} is no option", where="--set", expected="NAME=VALUE")
    try:
        return name, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value
