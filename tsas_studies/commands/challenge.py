"""`tsas challenge`: make a sealed set of recordings, let a tool diagnose it, score the answers."""

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, present, progress

challenge = typer.Typer(
    name="challenge",
    no_args_is_help=True,
    help="A blind benchmark of diagnosis, for this and any other tool (docs/challenge.md).",
)
SealedSet = Annotated[Path, typer.Argument(metavar="SET", help="A sealed set's folder.")]
Tool = Literal["diagnose", "bic", "training", "sparse"]
Kind = Literal["one", "pair", "triple", "nothing", "unknown", "near", "fault", "recording"]
Conditions = Literal["clean", "slow", "realistic"]


@challenge.command("make")
def make(
    out: OutFolder,
    seed: Annotated[
        int,
        typer.Option(
            "--seed",
            min=0,
            max=19_999,
            help="0 to 999 for tuning, 10000 to 19999 for scoring.",
        ),
    ],
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, help="How many seeds, from that one on.")
    ] = 1,
    small: Annotated[
        bool,
        typer.Option("--small", help="Each effect once at full size, and a few of what is none."),
    ] = False,
    kind: Annotated[
        Kind | None, typer.Option("--kind", help="Only cases in which this is hidden.")
    ] = None,
    conditions: Annotated[
        Conditions | None,
        typer.Option("--conditions", help="Only cases under these; slow: slow noise."),
    ] = None,
    rate: Annotated[
        float, typer.Option("--rate", metavar="HZ", min=50.0, max=500.0, help="Samples per second.")
    ] = 200.0,
    salt: Annotated[
        str | None,
        typer.Option("--salt", metavar="HEX", help="That of another set, to make it again."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Make recordings with known causes, and seal the truth beside them."""
    from tsas_studies.challenge.stages import make_set

    with progress("challenge", quiet=quiet) as step:
        result = make_set(
            out=out,
            seed=seed,
            seeds=seeds,
            small=small,
            kind=kind,
            conditions=conditions,
            rate_Hz=rate,
            salt=salt,
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)


@challenge.command("run")
def run(
    sealed: SealedSet,
    out: OutFolder,
    tool: Annotated[
        Tool, typer.Option("--tool", help="diagnose: this program's; the rest are baselines.")
    ] = "diagnose",
    workers: Annotated[
        int, typer.Option("--workers", min=1, help="How many cases at a time.")
    ] = os.cpu_count() or 1,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Diagnose every case of a sealed set; the answers stay unread."""
    from tsas_studies.challenge.stages import run_set

    with progress("challenge", quiet=quiet) as step:
        result = run_set(sealed, out=out, tool=tool, workers=workers, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)


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
    from tsas_studies.challenge.stages import score_set

    result = score_set(sealed, entries, out=out, force=force)
    present(result, quiet=quiet, as_json=as_json)
