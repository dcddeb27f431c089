"""`tsas challenge`: make a sealed set of recordings, let a tool diagnose it, score the answers."""

import os
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, progress, show

challenge = typer.Typer(
    name="challenge",
    no_args_is_help=True,
    help="A blind benchmark of diagnosis, for this and any other tool (docs/challenge.md).",
)
SealedSet = Annotated[Path, typer.Argument(metavar="SET", help="A sealed set's folder.")]


@challenge.command("run")
def run(
    sealed: SealedSet,
    out: OutFolder,
    workers: Annotated[
        int, typer.Option("--workers", min=1, help="How many cases at a time.")
    ] = os.cpu_count() or 1,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Diagnose every case of a sealed set with `tsas diagnose`; the answers stay unread."""
    from tsas_cli.challenge.run import case_folders, run_cases

    cases = len(case_folders(sealed))
    with progress("challenge", cases, quiet=quiet or as_json) as step:
        log = run_cases(sealed, out, workers=workers, force=force, step=step)
    title = f"{out}: {log['answered']} of {cases} cases answered"
    table = (title, ("no answer", "reason"), list(log["no_answer"].items()))
    show(log, [table], quiet=quiet, as_json=as_json)


@challenge.command("score")
def score(
    sealed: SealedSet,
    entries: Annotated[
        list[Path], typer.Argument(metavar="ENTRY", help="Folders with ID/diagnosis.json.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/score.json.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Score the answers of one or more tools against the truth, side by side."""
    from tsas_cli.challenge.score import score_entries
    from tsas_cli.challenge.tables import tables
    from tsas_cli.files import new_folder, write_json

    content = score_entries(sealed, entries)
    if out is not None:
        with new_folder(out, force=force) as folder:
            write_json(folder / "score.json", content)
    show(content, tables(content), quiet=quiet, as_json=as_json)
