"""A map proposed for raw files."""

import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.recordings.columns import has_input_and_output
from tsas_cli.recordings.guess.channels import channels
from tsas_cli.recordings.guess.clock import clock, like_a_clock, repeats
from tsas_cli.recordings.guess.columns import FileColumn, Proposed, columns_of, with_trusted_names
from tsas_cli.recordings.guess.looks import correlation
from tsas_cli.recordings.guess.opening import Keys, Opened, open_file, options_of
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.readers import names, stem
from tsas_cli.recordings.readers.table import ColumnSource
from tsas_cli.support.errors import InputError

_SPRING = 0.95  # least correlation of tension and displacement at the load of a spring


@dataclass(frozen=True)
class MapProposal:
    """A proposed map with its evidence."""

    name: str
    looked_at: Opened  # the file that the proposal is based on
    matching: tuple[Path, ...]  # other files with the same columns
    different: dict[Path, str]  # the rest of them, and how each differs
    read: Keys  # the keys of `[read]`
    channels: tuple[Proposed, ...]  # the tables of `[columns]`
    not_taken: dict[ColumnSource, str]  # the columns without a channel, and their evidence
    run: Keys  # the keys of `[run]` that differ from their defaults
    doubt: str  # why no column name is used; empty if names are used

    @property
    def questions(self) -> dict[str, str]:
        """The open questions, by their key in the map."""
        questions = {
            f"columns.{channel.name}.{key}": sentence
            for channel in self.channels
            for key, sentence in channel.questions.items()
        }
        return questions | {
            f"{table}.{key}": why
            for table, keys in (("read", self.read), ("run", self.run))
            for key, (value, why) in keys.items()
            if value == QUESTION
        }

    @property
    def is_a_recording(self) -> bool:
        """Whether the channels are enough for ingest: an input and an output."""
        there = (c.name for c in self.channels if c.candidates or c.entry.get("source") != QUESTION)
        return has_input_and_output(frozenset(there))


def propose(files: Sequence[Path]) -> MapProposal:
    """Return the map proposed for files; InputError: none of them can be read."""
    opened, different = _first_that_opens(files)
    matching: list[Path] = []
    options = options_of(opened.read)
    for path in files:
        if path == opened.path or path in different:
            continue
        try:
            if names(path, options) == names(opened.path, options):
                matching.append(path)
            else:
                different[path] = "its columns have other names, or another order"
        except InputError as error:
            different[path] = error.what
    columns, doubt = with_trusted_names(columns_of(opened))
    time = clock(columns, opened.left_out)
    rest = [c for c in columns if c.source != time.entry.get("source")]
    if time.entry.get("source") == QUESTION:
        rest = [c for c in rest if not like_a_clock(c)]
    found = (time, *channels(rest, opened.left_out))
    used = {channel.entry.get("source") for channel in found}
    used |= {source for channel in found for source in channel.candidates}
    return MapProposal(
        _name([opened.path, *matching]),
        opened,
        tuple(matching),
        different,
        opened.read
        | {key: (QUESTION, question) for key, question in opened.asked.items()}
        | _repeated(columns, time)
        | _pattern([opened.path, *matching], different),
        found,
        {c.source: _why_not(c) for c in columns if c.source not in used},
        _load(columns, found) | _id([opened.path, *matching]),
        doubt,
    )


def _name(paths: Sequence[Path]) -> str:
    """Return a dataset's name: that of the folder which holds all files."""
    folder = os.path.commonpath([path.absolute().parent for path in paths])
    return re.sub(r"[^\w-]+", "-", Path(folder).name or paths[0].stem).strip("-") or "rig"


def _first_that_opens(files: Sequence[Path]) -> tuple[Opened, dict[Path, str]]:
    failed: dict[Path, InputError] = {}
    for path in files:
        try:
            return open_file(path), {path: error.what for path, error in failed.items()}
        except InputError as error:
            failed[path] = error
    raise next(iter(failed.values()))


def _repeated(columns: Sequence[FileColumn], time: Proposed) -> Keys:
    """Return the question for the rows that repeat a time."""
    clocks = [column for column in columns if column.source == time.entry.get("source")]
    repeated = repeats(clocks[0].values) if clocks else 0
    if not repeated:
        return {}
    rows = clocks[0].values.size
    why = f'{repeated} of {rows} rows repeat the time before: is it "first", "last" or "mean" '
    return {"repeated_times": (QUESTION, f"{why}of each channel that stays?")}


def _pattern(good: Sequence[Path], different: dict[Path, str]) -> Keys:
    """Return the glob for the matching files of a folder, if their suffix distinguishes them."""
    suffixes = {path.suffix for path in good}
    if not different or len(suffixes) > 1 or suffixes & {path.suffix for path in different}:
        return {}
    return {"files": (f"*{suffixes.pop()}", "the other files hold no such table")}


def _id(paths: Sequence[Path]) -> Keys:
    counted = Counter(stem(path) for path in paths)
    duplicates = [name for name, count in counted.items() if count > 1]
    why = f"two files have the name {duplicates[0]}" if duplicates else ""
    return {"id": ("{folder}_{stem}", why)} if duplicates else {}


def _load(columns: Sequence[FileColumn], found: Sequence[Proposed]) -> Keys:
    """Return the question for the load, if its tension and displacement are not correlated."""
    by_source = {column.source: column for column in columns}
    at = {p.name: by_source.get(p.entry.get("source", "")) for p in found}
    force, displacement = at.get("f_out_N"), at.get("x_out_mm") or at.get("x_in_mm")
    if force is None or displacement is None:
        return {}
    r = abs(correlation(force.values, displacement.values))
    if r >= _SPRING:
        return {}
    why = (
        f"what is the distal end? {force.shown} does not follow {displacement.shown} as a spring's "
        f'tension does (correlation {r:.2f}): "spring", or "force" where f_out_N is driven, or '
        '"displacement" where x_out_mm is'
    )
    return {"load": (QUESTION, why)}


def _why_not(column: FileColumn) -> str:
    if not column.moves:
        return "it does not change"
    if column.words.is_reference:
        return f'"{column.words.matched["reference"]}" in its name: a reference, not a measurement'
    return "; ".join(column.reasons) or "nothing identifies it"
