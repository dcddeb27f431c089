"""`tsas check`: say what is wrong with recordings before anyone fits anything."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tsas_cli.commands.common import DatasetFolder, Force, Json, Quiet, Rrd, add_stream, show

if TYPE_CHECKING:
    from tsas_cli.recordings.quality import Report


def check(
    dataset: DatasetFolder,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/check.json.")
    ] = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say what is wrong with recordings before anyone fits anything."""
    from tsas_cli.errors import InputError
    from tsas_cli.files import new_folder, write_json
    from tsas_cli.recordings.dataset import read_dataset
    from tsas_cli.recordings.quality import check_dataset

    if rrd and out is None:
        raise InputError("--rrd has no folder to write to", remedy="give one with --out")
    opened = read_dataset(dataset)
    report = check_dataset(opened)
    content = opened.header("check", out or Path()) | report.content()
    if out is not None:
        with new_folder(out, force=force) as folder:
            write_json(folder / "check.json", content)
        if rrd:
            add_stream(out, quiet=quiet or as_json)
    show(content, _tables(report), quiet=quiet, as_json=as_json)


def _tables(report: "Report") -> Iterator[tuple[str, tuple[str, ...], Sequence[tuple[str, ...]]]]:
    """Yield what was found, what to do about it, and what could not be told."""
    found = [(str(f.severity), f.code, f.run or "", f.sentence) for f in report.findings]
    header = ("severity", "code", "run", "finding") if found else ()
    yield f"the checks found {len(found) or 'nothing'}", header, found
    remedies = dict.fromkeys((f.code, f.remedy) for f in report.findings)
    if remedies:
        yield "what to do", ("code", "remedy"), list(remedies)
    reasons: dict[tuple[str, str], list[str]] = {}
    for silent in report.not_checked:
        reasons.setdefault((silent.code, silent.reason), []).append(silent.run or "")
    if reasons:
        rows = [(code, reason, ", ".join(runs)) for (code, reason), runs in reasons.items()]
        yield "not checked", ("code", "reason", "runs"), rows
