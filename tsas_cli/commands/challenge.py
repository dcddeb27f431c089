"""`tsas challenge`: make a sealed set of recordings, let a tool diagnose it, score the answers."""

import os
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, show
from tsas_cli.commands.progress import progress

challenge = typer.Typer(
    name="challenge",
    no_args_is_help=True,
    help="A blind benchmark of diagnosis, for this and any other tool (docs/challenge.md).",
)
SealedSet = Annotated[Path, typer.Argument(metavar="SET", help="A sealed set's folder.")]


class ToolOption(StrEnum):
    """What can diagnose the cases of a set."""

    diagnose = "diagnose"
    bic = "bic"
    training = "training"
    sparse = "sparse"


class KindOption(StrEnum):
    """What can be hidden in a case."""

    one = "one"
    pair = "pair"
    nothing = "nothing"
    unknown = "unknown"


@challenge.command("make")
def make(
    out: OutFolder,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="0 to 999 for tuning, 10000 to 19999 for scoring.")
    ],
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, help="How many seeds, from that one on.")
    ] = 1,
    small: Annotated[
        bool,
        typer.Option("--small", help="Each effect once at full size, and a few of what is none."),
    ] = False,
    kind: Annotated[
        KindOption | None, typer.Option("--kind", help="Only cases in which this is hidden.")
    ] = None,
    rate: Annotated[
        float, typer.Option("--rate", metavar="HZ", min=50.0, max=500.0, help="Samples per second.")
    ] = 200.0,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Make recordings with known causes, and seal the truth beside them."""
    from collections import Counter

    from tsas_cli import __version__
    from tsas_cli.challenge.cases import cases, part
    from tsas_cli.challenge.make import make as make_set
    from tsas_cli.errors import InputError
    from tsas_cli.files import new_folder

    listed = [case for each in range(seed, seed + seeds) for case in cases(each)]
    if small:
        listed = list(part(listed))
    if kind is not None:
        listed = [case for case in listed if case.kind == kind.value]
    if not listed:
        raise InputError("--small keeps no case of --kind pair", remedy="leave one of them out")
    with (
        new_folder(out, force=force) as folder,
        progress("challenge", len(listed), quiet=quiet) as step,
    ):
        make_set(folder, listed, rate_Hz=rate, step=step)
    kinds = Counter(case.kind for case in listed)
    summary = {
        "format": 1,
        "stage": "challenge make",
        "version": __version__,
        "folder": str(out),
        "seed": seed,
        "seeds": seeds,
        "rate_Hz": rate,
        "cases": dict(kinds),
    }
    rows = [(kind, str(count)) for kind, count in kinds.items()]
    said = f"seed {seed}" if seeds == 1 else f"seeds {seed} to {seed + seeds - 1}"
    title = f"{out}: {len(listed)} cases of {said}"
    show(summary, [(title, ("hidden", "cases"), rows)], quiet=quiet, as_json=as_json)


@challenge.command("run")
def run(
    sealed: SealedSet,
    out: OutFolder,
    tool: Annotated[
        ToolOption, typer.Option("--tool", help="diagnose: this program's; the rest are baselines.")
    ] = ToolOption.diagnose,
    workers: Annotated[
        int, typer.Option("--workers", min=1, help="How many cases at a time.")
    ] = os.cpu_count() or 1,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Diagnose every case of a sealed set; the answers stay unread."""
    from tsas_cli.challenge.run import TOOLS, case_folders, run_cases

    cases = len(case_folders(sealed))
    with progress("challenge", cases, quiet=quiet) as step:
        log = run_cases(sealed, out, workers=workers, force=force, diagnose=TOOLS[tool], step=step)
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
