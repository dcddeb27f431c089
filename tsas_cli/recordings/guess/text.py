"""A proposed map as commented TOML, as JSON and as printed tables."""

import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

import tomlkit

from tsas_cli.recordings.columns import BY_NAME, COLUMNS, INPUTS, OUTPUTS
from tsas_cli.recordings.guess.columns import Proposed
from tsas_cli.recordings.guess.proposal import MapProposal
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.manifest import RigSheet
from tsas_cli.support.errors import printable

_WIDTH = 98
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
    blocks = [
        [line for sentence in _head(proposal) for line in _comment(sentence)],
        [
            "[dataset]",
            f"name = {_toml(proposal.name)} # the folder's name",
            '# description = "…"',
        ],
        [
            "[rig]",
            "# The data sheet of the rig; each line is optional:",
            *(f"# {key} =" for key in list(RigSheet.model_fields)[:4]),
        ],
    ]
    if proposal.read or proposal.not_taken or proposal.looked_at.left_out:
        blocks.append(["[read]", *_read(proposal)])
    blocks += [[f"[columns.{channel.name}]", *_channel(channel)] for channel in proposal.channels]
    blocks.append(["[run]", *_run(proposal)])
    return "\n\n".join("\n".join(lines) for lines in blocks) + "\n"


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


def _read(proposal: MapProposal) -> Iterator[str]:
    for key, (value, why) in proposal.read.items():
        yield from _key(key, value, why)
    if proposal.not_taken:
        yield "# These columns have no channel; extra would keep them unchanged:"
        for source, reason in proposal.not_taken.items():
            yield from _comment(f"- {source}: {reason}.", indent="  ")
        yield f"# extra = [{', '.join(map(_toml, proposal.not_taken))}]"
    for name, reason in proposal.looked_at.left_out.items():
        yield from _comment(f"{name} cannot be used: {reason}.")


def _channel(channel: Proposed) -> Iterator[str]:
    meaning = BY_NAME[channel.name].meaning
    yield from _comment(f"{meaning[0].upper()}{meaning[1:]}: {channel.certainty}.")
    for sentence in (*channel.why, *(f"alternative: {other}" for other in channel.alternatives)):
        yield from _comment(f"- {sentence}", indent="  ")
    for key, value in channel.entry.items():
        yield from _key(key, value, channel.questions.get(key, ""))


def _run(proposal: MapProposal) -> Iterator[str]:
    for key, (value, why) in proposal.run.items():
        yield from _key(key, value, why)
    pattern, groups = conditions_in(proposal.looked_at.path)
    for condition, (meaning, _) in _CONDITIONS.items():
        if condition not in groups:
            yield f"# {condition} =   # for all runs: {meaning}"
    if groups:
        name = proposal.looked_at.path.name
        yield from _comment(f"The file name {name} may hold these; if so, uncomment:")
        yield "# [run.from_file_name]"
        yield f"# pattern = '(?i){pattern}'"
        for condition, (group, unit) in groups.items():
            yield f"# [run.conditions.{condition}]"
            yield f'# from = "{group}"'
            yield f'# unit = "{unit}"'
    there = {channel.name for channel in proposal.channels}
    there |= {  # a single column is asked about at the drive, and may be at the load
        c.name.replace("_in_", "_out_") for c in proposal.channels if len(c.candidates) == 1
    }
    for column in COLUMNS[:5]:
        if column.name not in there:
            yield from _comment(f"No column looks like {column.name} ({column.meaning}).")


def _key(key: str, value: Any, why: str) -> Iterator[str]:
    if why:
        sentence = f"QUESTION: {why}" if value == QUESTION else f"{why[0].upper()}{why[1:]}"
        yield from _comment(sentence if sentence.endswith(("?", ".")) else f"{sentence}.")
    yield f"{key} = {_toml(value)}"


def _toml(value: Any) -> str:
    return str(tomlkit.item(value).as_string())


def _comment(text: str, *, indent: str = "") -> list[str]:
    return wrap(
        printable(text),
        _WIDTH,
        initial_indent="# ",
        subsequent_indent=f"# {indent}",
        break_long_words=False,
        break_on_hyphens=False,
    )


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
