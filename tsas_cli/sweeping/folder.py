"""The folder of a sweep: one at a time writes to it, and what is done in it stays."""

import fcntl
import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

from tsas_cli.errors import InputError
from tsas_cli.files import read_json
from tsas_cli.sweeping.answer import Answer, success
from tsas_cli.sweeping.tasks import FILE, Task

TASKS = "tasks"
JOURNAL = "journal.jsonl"  # when what was done where; it also says that this is a sweep's folder
NOTED = ("state", "seconds", "processor_seconds", "where", "error")
TABLE, PARAMETERS, SUMMARY = "sweep.parquet", "parameters.parquet", "sweep.json"


@contextmanager
def sweep_folder(out: Path) -> Iterator[Path]:
    """Yield the folder for the tasks of a sweep; nobody else writes to it meanwhile.

    What a killed worker has left half-made is taken away, before and after.

    Raises
    ------
    InputError
        Another sweep writes to it, it holds something else, or it cannot be written.
    """
    tasks = out / TASKS
    with _taken(out):
        _clear(tasks)
        try:
            yield tasks
        finally:
            _clear(tasks)


def _taken(out: Path) -> TextIO:
    """Return the journal of a sweep's folder, open and locked until it is closed."""
    try:
        if out.is_dir() and any(out.iterdir()) and not (out / JOURNAL).is_file():
            raise InputError(
                "holds something else than an earlier sweep",
                where=out,
                expected="a name that is free, or a sweep to go on with",
                remedy="choose another --out",
            )
        (out / TASKS).mkdir(parents=True, exist_ok=True)
        journal = (out / JOURNAL).open("a", encoding="utf-8")
        _lock(journal, out)
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror})",
            where=out,
            remedy="choose an --out in a folder that you may write to",
        ) from error
    return journal


def _lock(journal: TextIO, out: Path) -> None:
    """Take the folder; the lock ends with the process, however that ends."""
    try:
        fcntl.flock(journal.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        journal.close()
        raise InputError(
            "another sweep is writing here", where=out, remedy="wait for it, or stop it"
        ) from error


def _clear(tasks: Path) -> None:
    for path in tasks.glob(".*"):
        shutil.rmtree(path, ignore_errors=True)


def what_is_done(tasks: Path, task: Task) -> Answer | None:
    """Return what a finished task has found, or None where it is still to be done."""
    path = tasks / task.key / FILE
    if not path.is_file():
        return None
    content: Mapping[str, Any] = read_json(path)
    return success(content["results"], content["parameters"])


def note(out: Path, task: Task, answer: Answer) -> None:
    """Add a line to the journal: which task ended how, after how many seconds, where."""
    line = {"task": task.key, **{key: answer.get(key) for key in NOTED}}
    with (out / JOURNAL).open("a", encoding="utf-8") as journal:
        journal.write(json.dumps(line, ensure_ascii=False) + "\n")
