"""Diagnose every case of a sealed set, each in a process of its own; the answers stay unread."""

import os
import shutil
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from tsas_cli.records.diagnosis import RecordingFault
from tsas_cli.stages.check import check
from tsas_cli.stages.diagnose import diagnose as diagnose_recordings
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, stage_folder, write_json, write_sums
from tsas_cli.support.limits import THREADS
from tsas_studies.challenge.baselines import bic, sparse, training
from tsas_studies.challenge.entry import FILE, LOG
from tsas_studies.challenge.sums import CASES, DATASET

Diagnose = Callable[[Path, Path], None]

# A case is one process on one core, and a file in the folder that it starts in is no module.
NOTHING_LEFT = {"unexplained": False}
SURROUNDINGS = {"OPENBLAS_NUM_THREADS": "1", THREADS: "1", "PYTHONSAFEPATH": "1"}


def diagnose(dataset: Path, out: Path) -> None:
    """Check and diagnose one dataset with this program; writes `out/diagnosis.json`.

    Where a fault stops the diagnosis, what the checks find is the answer.
    """
    found = [one for one in check(dataset).findings if one.severity != "note"]
    faults = [RecordingFault.model_validate(vars(one)).content() for one in found]
    try:
        diagnose_recordings(dataset, out=out)
        content = read_json(out / FILE)
    except InputError:
        if not faults:
            raise
        out.mkdir()
        content = {"format": 1, "verdict": "undecided", "named": [], "remainder": NOTHING_LEFT}
    there = content.get("faults", [])
    content["faults"] = [*there, *(fault for fault in faults if fault not in there)]
    write_json(out / FILE, content)


TOOLS: dict[str, Diagnose] = {
    "diagnose": diagnose,
    "bic": bic,
    "training": training,
    "sparse": sparse,
}


def case_folders(sealed: Path) -> list[Path]:
    """Return the folders of the cases in a sealed set.

    InputError: there is none, or one is a link.
    """
    folders = sorted(path.parent for path in sealed.glob(f"{CASES}/*/{DATASET}"))
    for folder in folders:
        for path in (sealed / CASES, folder, folder / DATASET):
            if path.is_symlink():
                raise InputError(
                    "is a link",
                    where=path,
                    expected="the folder of a case",
                    remedy="make the set again with `tsas challenge make`",
                )
    if not folders:
        raise InputError(
            "no cases/ID/dataset here",
            where=sealed,
            expected="the folder of a sealed set",
            remedy="make one with `tsas challenge make`",
        )
    return folders


def run_cases(
    sealed: Path,
    out: Path,
    *,
    workers: int,
    force: bool = False,
    diagnose: Diagnose = diagnose,
    step: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Write `out/ID/diagnosis.json` for every case, and `out/entry.json`, which is returned.

    `diagnose(dataset, out)` has to be importable by its name: it runs in new processes. What it
    raises, or that its process died, is the reason why a case has no answer.

    InputError: the set has no cases, or `out` exists and `force` is not set.
    """
    folders = case_folders(sealed)
    reasons: dict[str, str] = {}
    with (
        stage_folder(out, stage="challenge run", inputs=[sealed], force=force) as entry,
        _surrounded(),
        ThreadPoolExecutor(workers) as threads,
    ):
        tasks = {
            threads.submit(_in_a_process, diagnose, case / "dataset", entry / case.name): case.name
            for case in folders
        }
        try:
            for task in as_completed(tasks):
                reason = task.result()
                if reason is not None:
                    reasons[tasks[task]] = reason
                step()
        except BaseException:
            threads.shutdown(wait=False, cancel_futures=True)
            raise
        log = {
            "format": 1,
            "stage": "challenge run",
            "version": __version__,
            "tool": diagnose.__name__,
            "answered": len(folders) - len(reasons),
            "no_answer": {c.name: reasons[c.name] for c in folders if c.name in reasons},
        }
        write_json(entry / LOG, log)
    return log


@contextmanager
def _surrounded() -> Iterator[None]:
    """Let processes that are started in the block have `SURROUNDINGS`, where nobody says others."""
    missing = SURROUNDINGS.keys() - os.environ.keys()
    os.environ.update({name: SURROUNDINGS[name] for name in missing})
    try:
        yield
    finally:
        for name in missing:
            del os.environ[name]


def _in_a_process(diagnose: Diagnose, dataset: Path, out: Path) -> str | None:
    """Return why there is no answer, or None; a process of its own takes nobody along."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        try:
            reason = process.submit(_timed, diagnose, dataset, out).result()
        except BrokenProcessPool:
            reason = "the process died"
    if reason is not None:  # half an answer is none
        shutil.rmtree(out, ignore_errors=True)
    return reason


def _timed(diagnose: Diagnose, dataset: Path, out: Path) -> str | None:
    """Diagnose, and write into the diagnosis how long it took; return what went wrong."""
    start = time.perf_counter()
    try:
        diagnose(dataset, out)
        seconds = time.perf_counter() - start
        content = read_json(out / FILE)
        write_json(out / FILE, content | {"seconds": seconds})
        write_sums(out)  # of what is there now
    except InputError as error:
        return error.line()
    except Exception as error:  # noqa: BLE001 # the other cases go on; the reason is written down
        return f"{type(error).__name__}: {error}"
    return None
