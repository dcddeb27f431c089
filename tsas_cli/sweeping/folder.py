"""The folder of a sweep: one process writes to it at a time, and completed tasks are kept."""

import fcntl
import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from tsas_cli.support.errors import InputError
from tsas_cli.support.files import own_file, read_json, sha256_of, sums_text, unwritable
from tsas_cli.support.limits import text_name
from tsas_cli.support.replacing import (
    LEFT_BY_DESKTOPS,
    SUMS,
    refuse_holding,
    refuse_kind,
    refuse_others,
)
from tsas_cli.support.temporaries import TEMPORARY, is_empty_folder, remove
from tsas_cli.sweeping.outcome import TaskOutcome, success
from tsas_cli.sweeping.tasks import TASK_FILE, Task
from tsas_cli.verifying.claims import claims_of

TASKS = "tasks"
JOURNAL = "journal.jsonl"  # log of tasks: when and where; it also marks the folder of a sweep
LOGGED = ("state", "seconds", "processor_seconds", "where", "error")
TABLE, PARAMETERS, SUMMARY = "sweep.parquet", "parameters.parquet", "sweep.json"
SEALED = (PARAMETERS, SUMMARY, TABLE)  # a task's folder has checksums of its own


@contextmanager
def sweep_folder(out: Path, inputs: Iterable[Path]) -> Iterator[Path]:
    """Yield the folder for the tasks of a sweep, locked against other processes.

    Temporary files of killed workers are removed before and after.

    InputError: another sweep writes to it, it holds something else or an input, or it cannot be
    written.
    """
    text_name(out.absolute())
    refuse_kind(out, folder=True)
    refuse_holding(out, inputs)
    tasks = out / TASKS
    with _locked_journal(out):
        with _writing(out):
            tasks.mkdir(exist_ok=True)
        _clear(tasks)
        try:
            yield tasks
        finally:
            _clear(tasks)


def _locked_journal(out: Path) -> TextIO:
    """Return the journal of a sweep's folder, open, and locked until it is closed."""
    with _writing(out):
        if out.is_dir():
            _refuse_foreign(out)
        out.mkdir(parents=True, exist_ok=True)
        journal = (out / JOURNAL).open("a", encoding="utf-8")
        _lock(journal, out)
    return journal


def _refuse_foreign(out: Path) -> None:
    """Refuse a folder of another kind, or with files of other origin; an empty one is a sweep's."""
    present = {path.name for path in out.iterdir() if not TEMPORARY.search(path.name)}
    if JOURNAL in present or {TASKS, SUMMARY} <= present:
        ours = {TASKS, JOURNAL, SUMS, *SEALED} | LEFT_BY_DESKTOPS
        refuse_others(out, sorted(present - ours), "sweep")
    elif not all(name == TASKS and is_empty_folder(out / name) for name in present):
        raise InputError(
            "is no folder of an earlier sweep",
            where=out,
            expected="a new name, or a sweep to resume",
            remedy="choose another --out",
        )


@contextmanager
def _writing(out: Path) -> Iterator[None]:
    """Convert errors of writing to a sweep's folder to `InputError`."""
    try:
        yield
    except OSError as error:
        raise unwritable(out, error) from error


def _lock(journal: TextIO, out: Path) -> None:
    """Lock the folder; the lock ends with the process, however it ends."""
    try:
        fcntl.flock(journal.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        journal.close()
        raise InputError(
            "another sweep is writing here", where=out, remedy="wait for it, or stop it"
        ) from error


def _clear(tasks: Path) -> None:
    for path in tasks.glob(".*"):
        with suppress(OSError):
            remove(path)


def seal(out: Path) -> None:
    """Write the checksums of the sweep's own files, but for its journal, which grows."""
    there = [path for path in (out / name for name in SEALED) if path.is_file()]
    with own_file(out / SUMS) as path:
        path.write_text(sums_text(out, there), encoding="utf-8")


def what_is_done(tasks: Path, key: str) -> TaskOutcome | None:
    """Return the outcome of a completed task, or None.

    A task is completed if its `task.json` exists and every file in its checksums is unchanged; else
    it is repeated.
    """
    folder = tasks / key
    try:
        sums = {folder / claim.file: claim.sha256 for claim in claims_of(folder / SUMS)}
        if folder / TASK_FILE not in sums or any(sha256_of(path) != sums[path] for path in sums):
            return None
        content = read_json(folder / TASK_FILE)
        return success(content["results"], content["parameters"]) if content["key"] == key else None
    except (InputError, OSError, KeyError, TypeError):
        return None


def note(out: Path, task: Task, outcome: TaskOutcome) -> None:
    """Append a task's state, duration and machine to the journal."""
    line = {"task": task.key, **{key: outcome.get(key) for key in LOGGED}}
    with _writing(out / JOURNAL), (out / JOURNAL).open("a", encoding="utf-8") as journal:
        journal.write(json.dumps(line, ensure_ascii=False) + "\n")
