"""The conditions of a run, from its file name, its header and the map."""

import re
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from tsas_cli.recordings.ingest_map import Converted, FromText, RunMap
from tsas_cli.recordings.readers import stem
from tsas_cli.recordings.readers.layout import may_be_thousands
from tsas_cli.recordings.units import conversion
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw

SEARCH_TIMEOUT_S = 10.0  # of a pattern, whose search may take exponential time
_UNITS = {"preload_N": "N", "sheath_length_mm": "mm", "total_bend_rad": "rad"}


def run_conditions(
    path: Path, header: Sequence[str], run_map: RunMap, decimal: str | None = None
) -> Raw:
    """Return a run's id, its conditions and the other named groups of its file name and header.

    Later sources take precedence: `[run]`, the file name (with its folder), the header, the
    converted groups, the table entry of the run's id. A comma is a decimal mark; an ambiguous one
    (1,250 may be thousands) needs `decimal`.

    InputError: a pattern does not match, a group is missing, no number or ambiguous by a factor of
    1000, or a unit does not fit.
    """
    folder = path.absolute().parent.name
    groups = _groups(run_map.from_file_name, f"{folder}/{path.name}", path)
    groups |= _groups(run_map.from_header, "\n".join(header), path)
    for key, text in groups.items():
        if decimal != "," and may_be_thousands(text):
            raise InputError(
                f"group {key} is {text}: is the comma a decimal mark or a thousands separator?",
                where=path,
                remedy='set decimal = "," under [read] of the map, or the value itself under [run]',
            )
    name = _filled(run_map.id, {"stem": stem(path), "folder": folder} | groups)
    converted = {
        condition: _converted(condition, rule, groups, path)
        for condition, rule in run_map.conditions.items()
    }
    used = {rule.group for rule in run_map.conditions.values()}
    direct = {
        key: text if key == "started" else _plain(text)  # 20260302 is a date, no number
        for key, text in groups.items()
        if key not in used
    }
    defaults = run_map.model_dump(include={"load", *_UNITS}, exclude_none=True)
    return defaults | direct | converted | run_map.table.get(name, {}) | {"id": name}


def _converted(condition: str, rule: Converted, groups: dict[str, str], path: Path) -> float:
    if rule.group not in groups:
        hint = nearest(rule.group, groups)
        raise InputError(f"no group {rule.group} for {condition}", where=path, remedy=hint)
    value = _plain(groups[rule.group])
    if isinstance(value, str):
        raise InputError(f"group {rule.group} is {value!r}", where=path, expected="a number")
    where = f"run.conditions.{condition} of the map"
    slope, intercept = conversion(rule.unit, _UNITS[condition], where=where)
    return slope * value + intercept


def _groups(rule: FromText | None, text: str, path: Path) -> dict[str, str]:
    if rule is None:
        return {}
    shown = text if len(text) <= 60 else f"{text[:60]}…"
    try:
        with at_most(SEARCH_TIMEOUT_S):
            found = rule.pattern.search(text)
    except TimeoutError as error:
        raise InputError(
            f"the pattern {rule.pattern.pattern!r} has not finished searching {shown!r} "
            f"after {SEARCH_TIMEOUT_S:g} s",
            where=path,
            remedy="nested repetitions, such as (a+)+, take exponential time: simplify it",
        ) from error
    if found is None:
        raise InputError(
            f"the pattern {rule.pattern.pattern!r} does not match {shown!r}", where=path
        )
    return {key: value for key, value in found.groupdict().items() if value is not None}


def _filled(template: str, words: dict[str, str]) -> str:
    def word(match: re.Match[str]) -> str:
        if match[1] not in words:
            hint = nearest(match[1], words)
            raise InputError(f"run.id: {{{match[1]}}} is unknown", remedy=hint)
        return words[match[1]]

    return re.sub(r"\{(\w+)\}", word, template)


def _plain(text: str) -> float | int | str:
    """Return text as a number where it is one, else unchanged."""
    for kind in (int, float) if "_" not in text else ():  # Python reads 1_2 as 12
        try:
            return kind(text.replace(",", "."))
        except ValueError:
            continue
    return text


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Run the block with a time limit; without one on Windows and outside the main thread.

    TimeoutError: the block took longer.
    """

    def late(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise TimeoutError

    on_main = threading.current_thread() is threading.main_thread()
    if not on_main or not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
