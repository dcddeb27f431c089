"""A whole map proposed for files that nobody has described yet."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.recordings.columns import has_input_and_output
from tsas_cli.recordings.guess.channels import channels
from tsas_cli.recordings.guess.clock import clock, like_a_clock
from tsas_cli.recordings.guess.columns import Column, believed, columns_of
from tsas_cli.recordings.guess.looks import together
from tsas_cli.recordings.guess.opening import Opened, open_file
from tsas_cli.recordings.guess.proposed import Proposed
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.readers import names
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source
from tsas_cli.support.errors import InputError

_SPRING = 0.95  # the correlation of tension and displacement at the load, at least, of a spring


@dataclass(frozen=True)
class Proposal:
    """What a proposed map says, and what it was told by.

    Attributes
    ----------
    looked_at
        The file whose columns and signals were looked at.
    alike, unlike
        The other files: those with the same columns, and why each of the rest is none.
    read
        The keys of `[read]`, with values and reasons.
    channels
        The tables of `[columns]`.
    not_taken
        The columns that no channel takes, and what is known of them.
    run
        The keys of `[run]` that are not as usual, with values and reasons.
    doubt
        Why no name is believed, empty where names are.
    """

    name: str
    looked_at: Opened
    alike: tuple[Path, ...]
    unlike: dict[Path, str]
    read: dict[str, tuple[Any, str]]
    channels: tuple[Proposed, ...]
    not_taken: dict[Source, str]
    run: dict[str, tuple[Any, str]]
    doubt: str

    @property
    def questions(self) -> dict[str, str]:
        """What is open, by its key in the map."""
        asked = {
            f"columns.{channel.name}.{key}": sentence
            for channel in self.channels
            for key, sentence in channel.questions.items()
        }
        return asked | {
            f"run.{k}": why for k, (value, why) in self.run.items() if value == QUESTION
        }

    @property
    def is_a_recording(self) -> bool:
        """Whether the channels are enough for ingest: an input and an output."""
        return has_input_and_output(frozenset(channel.name for channel in self.channels))


def propose(files: Sequence[Path]) -> Proposal:
    """Look at files and propose a map for them.

    Raises
    ------
    InputError
        None of them can be read.
    """
    opened, unlike = _first_that_opens(files)
    alike: list[Path] = []
    for path in files:
        if path != opened.path and path not in unlike:
            reason = _unlike(path, opened)
            unlike |= {path: reason} if reason else {}
            alike += [] if reason else [path]
    columns, doubt = believed(columns_of(opened))
    time = clock(columns)
    rest = [c for c in columns if c.source != time.entry.get("source")]
    if time.entry.get("source") == QUESTION:
        rest = [c for c in rest if not like_a_clock(c)]
    found = (time, *channels(rest))
    return Proposal(
        _name(opened.path),
        opened,
        tuple(alike),
        unlike,
        opened.read | _pattern([opened.path, *alike], unlike),
        found,
        _not_taken(columns, found),
        _load(columns, found) | _id([opened.path, *alike]),
        doubt,
    )


def _first_that_opens(files: Sequence[Path]) -> tuple[Opened, dict[Path, str]]:
    failed: dict[Path, InputError] = {}
    for path in files:
        try:
            return open_file(path), {path: error.what for path, error in failed.items()}
        except InputError as error:
            failed[path] = error
    raise next(iter(failed.values()))


def _unlike(path: Path, opened: Opened) -> str:
    """Return why a file does not go with the one that was looked at; empty where it does."""
    options = ReadOptions.model_validate({key: value for key, (value, _) in opened.read.items()})
    try:
        there = names(path, options)
    except InputError as error:
        return error.what
    mine = names(opened.path, options)
    return "" if there == mine else "its columns have other names, or another order"


def _pattern(good: Sequence[Path], unlike: dict[Path, str]) -> dict[str, tuple[Any, str]]:
    """Return which files of a folder to take, where their suffix tells them from the rest."""
    suffixes = {path.suffix for path in good}
    if not unlike or len(suffixes) > 1 or suffixes & {path.suffix for path in unlike}:
        return {}
    return {"files": (f"*{suffixes.pop()}", "the other files hold no such table")}


def _name(path: Path) -> str:
    return re.sub(r"[^\w-]+", "-", path.absolute().parent.name or path.stem).strip("-") or "rig"


def _id(paths: Sequence[Path]) -> dict[str, tuple[Any, str]]:
    twice = [stem for stem, count in Counter(path.stem for path in paths).items() if count > 1]
    why = f"two files are called {twice[0]}" if twice else ""
    return {"id": ("{folder}_{stem}", why)} if twice else {}


def _load(columns: Sequence[Column], found: Sequence[Proposed]) -> dict[str, tuple[Any, str]]:
    """Return the question what the load is, where tension and motion do not go together there."""
    by_source = {column.source: column for column in columns}
    at = {p.name: by_source.get(p.entry.get("source", "")) for p in found}
    force, place = at.get("f_out_N"), at.get("x_out_mm") or at.get("x_in_mm")
    if force is None or place is None:
        return {}
    like = abs(together(force.values, place.values))
    if like >= _SPRING:
        return {}
    why = (
        f"what is the distal end? {force.shown} does not go with {place.shown} as a spring's "
        f'tension does (correlation {like:.2f}): "spring", or "force" where f_out_N is driven, or '
        '"displacement" where x_out_mm is'
    )
    return {"load": (QUESTION, why)}


def _not_taken(columns: Sequence[Column], found: Sequence[Proposed]) -> dict[Source, str]:
    taken = {channel.entry.get("source") for channel in found}
    taken |= {source for channel in found for source in channel.candidates}
    return {c.source: _why_not(c) for c in columns if c.source not in taken}


def _why_not(column: Column) -> str:
    if not column.moves:
        return "it does not change"
    if column.words.wish:
        return f'"{column.words.told["wish"]}" in its name: it was wanted, not measured'
    return "; ".join(column.reasons) or "nothing says what it is"
