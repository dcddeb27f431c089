"""A proposed map as commented TOML, as JSON and as printed tables."""

import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

import tomlkit
from tomlkit.items import Table

from tsas_cli.recordings.columns import BY_NAME, COLUMNS, INPUTS, OUTPUTS
from tsas_cli.recordings.guess.columns import Proposed
from tsas_cli.recordings.guess.proposal import MapProposal
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.manifest import RigSheet
from tsas_cli.support.errors import printable

_WIDTH = 96
# Meaning of a condition; its group, the words before its number in a file name, and likely unit.
_CONDITIONS = {
    "sheath_length_mm": (
        "the length of the sheath",
        ("length", r"length|len|laenge|sheath|l", "mm"),
    ),
    "total_bend_rad": (
        "its total bend, 3.1416 for half a turn",
        ("bend", r"bend|bending|theta|wrap|biegung|winkel|angle", "deg"),
    ),
    "preload_N": (
        "the tension at rest",
        ("preload", r"preload|pretension|vorspannung|vorlast|f0", "N"),
    ),
}
_NUMBER = r"\d+(?:\.\d+)?"
MAP_MARK = b"# A map for `tsas ingest`"  # beginning of a proposed map


def map_text(proposal: MapProposal) -> str:
    """Return the text of the map; a comment above each key states its evidence."""
    document = tomlkit.document()
    for sentence in _head(proposal):
        _comment(document, sentence)
    dataset, rig = tomlkit.table(), tomlkit.table()
    dataset.add("name", proposal.name)
    dataset["name"].comment("the folder's name")
    dataset.add(tomlkit.comment('description = "…"'))
    document.add("dataset", dataset)
    _comment(rig, "The data sheet of the rig; each line is optional:")
    for key in list(RigSheet.model_fields)[:4]:
        rig.add(tomlkit.comment(f"{key} ="))
    document.add("rig", rig)
    if proposal.read or proposal.not_taken or proposal.looked_at.left_out:
        document.add("read", _read(proposal))
    columns = tomlkit.table(is_super_table=True)
    for channel in proposal.channels:
        columns.add(channel.name, _channel(channel))
    document.add("columns", columns)
    document.add("run", _run(proposal))
    return tomlkit.dumps(document).rstrip("\n") + "\n"


def _head(proposal: MapProposal) -> Iterator[str]:
    opened = proposal.looked_at
    rows = next(iter(opened.table.columns.values())).size
    yield (
        f"A map for `tsas ingest`, proposed after a look at {opened.path.name} ({rows} rows). "
        "Check every line: each is a guess, and the comment above it states its evidence and "
        "certainty."
    )
    if more := len(proposal.matching):
        yield f"{more} more {'file has' if more == 1 else 'files have'} the same columns."
    if proposal.doubt:
        yield proposal.doubt
    for path, reason in proposal.different.items():
        yield f"{path.name} does not match: {reason}."
    if proposal.different:
        yield (
            "A file of another device that belongs to the same run is joined by a list (.join, "
            "docs/ingest.md)."
        )
    if asked := len(proposal.questions):
        yield (
            f"{asked} question{'s are' if asked > 1 else ' is'} open: ingest stops until each "
            f'"{QUESTION}" is replaced.'
        )
    elif proposal.is_a_recording:
        yield "No question is open: the map is ready for ingest."
    if not proposal.is_a_recording:
        yield (
            f"Ingest needs one of {', '.join(INPUTS)}, and another of {', '.join(OUTPUTS)}: no "
            "such columns were found."
        )


def _read(proposal: MapProposal) -> Table:
    table = tomlkit.table()
    for key, (value, why) in proposal.read.items():
        _add(table, key, value, why)
    if proposal.not_taken:
        _comment(table, "These columns have no channel; extra would keep them unchanged:")
        for source, reason in proposal.not_taken.items():
            _comment(table, f"- {source}: {reason}.", indent="  ")
        listed = ", ".join(tomlkit.item(source).as_string() for source in proposal.not_taken)
        table.add(tomlkit.comment(f"extra = [{listed}]"))
    for name, reason in proposal.looked_at.left_out.items():
        _comment(table, f"{name} cannot be used: {reason}.")
    return table


def _channel(channel: Proposed) -> Table:
    table = tomlkit.table()
    meaning = BY_NAME[channel.name].meaning
    _comment(table, f"{meaning[0].upper()}{meaning[1:]}: {channel.certainty}.")
    for sentence in channel.why:
        _comment(table, f"- {sentence}", indent="  ")
    for other in channel.alternatives:
        _comment(table, f"- alternative: {other}", indent="  ")
    for key, value in channel.entry.items():
        _add(table, key, value, channel.questions.get(key, ""))
    return table


def _run(proposal: MapProposal) -> Table:
    table = tomlkit.table()
    for key, (value, why) in proposal.run.items():
        _add(table, key, value, why)
    pattern, groups = conditions_in(proposal.looked_at.path)
    for condition, (meaning, _) in _CONDITIONS.items():
        if condition not in groups:
            _comment(table, f"{condition} =   # for all runs: {meaning}")
    if groups:
        _comment(
            table, f"The file name {proposal.looked_at.path.name} may hold these; if so, uncomment:"
        )
        lines = ["[run.from_file_name]", f"pattern = '(?i){pattern}'"]
        for condition, (group, unit) in groups.items():
            lines += [f"[run.conditions.{condition}]", f'from = "{group}"', f'unit = "{unit}"']
        for line in lines:
            table.add(tomlkit.comment(line))
    missing = [c for c in COLUMNS[:5] if c.name not in {p.name for p in proposal.channels}]
    for column in missing:
        _comment(table, f"No column looks like {column.name} ({column.meaning}).")
    return table


def _add(table: Table, key: str, value: Any, why: str) -> None:
    if why:
        sentence = f"QUESTION: {why}" if value == QUESTION else f"{why[0].upper()}{why[1:]}"
        _comment(table, sentence if sentence.endswith(("?", ".")) else f"{sentence}.")
    table.add(key, value)


def _comment(table: Table | tomlkit.TOMLDocument, text: str, *, indent: str = "") -> None:
    lines = wrap(
        printable(text),
        _WIDTH,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    for line in lines:
        table.add(tomlkit.comment(line))


def conditions_in(path: Path) -> tuple[str, dict[str, tuple[str, str]]]:
    """Return a pattern for a file name, and group and likely unit of each condition in it.

    Both are empty without a word of a condition before a number.
    """
    found: list[tuple[int, str, str]] = []
    groups: dict[str, tuple[str, str]] = {}
    for condition, (_, (group, words, unit)) in sorted(_CONDITIONS.items(), key=lambda c: c[1][1]):
        match = re.search(rf"(?i)(?<![a-z])({words})([_=-]?){_NUMBER}", path.stem)
        if match:
            text = f"{re.escape(match[1] + match[2])}(?P<{group}>{_NUMBER})"
            found.append((match.start(), text, condition))
            groups[condition] = (group, unit)
    return ".*?".join(text for _, text, _ in sorted(found)), groups


def content(proposal: MapProposal) -> dict[str, object]:
    """Return the proposal with the text of its map, as JSON holds it (docs/ingest.md)."""
    return {
        "looked_at": str(proposal.looked_at.path),
        "unlike": {str(path): reason for path, reason in proposal.different.items()},
        "columns": {
            channel.name: {
                "entry": channel.entry,
                "sure": channel.certainty,
                "why": channel.why,
                "alternatives": channel.alternatives,
            }
            for channel in proposal.channels
        },
        "not_taken": proposal.not_taken,
        "questions": proposal.questions,
        "map": map_text(proposal),
    }


def tables(proposal: MapProposal, out: object) -> Iterator[tuple[str, tuple[str, ...], list[Any]]]:
    """Yield the tables of the channels with their sources, and of the open questions."""
    rows = [
        (channel.name, str(channel.entry.get("source", "")), channel.certainty)
        for channel in proposal.channels
    ]
    yield f"map {out}", ("channel", "source", "certainty"), rows
    if proposal.different:
        others = [(path.name, reason) for path, reason in proposal.different.items()]
        yield "files that do not match", ("file", "reason"), others
    if proposal.questions:
        yield "open questions", ("key", "question"), list(proposal.questions.items())
