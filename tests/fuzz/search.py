"""One target searched in processes of its own, a new one for each that dies."""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

MOST_DEATHS = 5  # of processes by the program, after which a target is given up
MOST_BYTES = 2000  # of an input, where a target says nothing else
HANG_S = 10
ALONE_S = 3 * HANG_S  # with the start of a process and the seeds
LOG = "log.txt"
MEMORY = Path("/dev/shm")  # noqa: S108 # files that never reach a disk, where there are such
MOST_KEPT, MOST_KEPT_BYTES = 60, 16_000  # of a target's corpus


@dataclass(frozen=True)
class Budget:
    """How long a target is searched: executions (-1: any number), seconds (0: any), seed."""

    runs: int
    seconds: int
    seed: int


@dataclass(frozen=True)
class Found:
    """What a search came to."""

    target: str
    executions: int
    seconds: float
    inputs: int
    edges: int
    faults: tuple[Path, ...]


def search(module: ModuleType, budget: Budget, corpus: Path, out: Path) -> Found:
    """Search one target, from the kept corpus and its seeds on.

    What is learned goes into `out/corpus/NAME`, inputs that break a rule into `out/found/NAME`.
    """
    target = module.__name__
    name = target.rpartition(".")[2]
    learned, found = out / "corpus" / name, out / "found" / name
    shutil.rmtree(found, ignore_errors=True)
    for folder in (learned, found):
        folder.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(module.seeds()):
        (learned / f"seed-{number}").write_bytes(seed)
    words = out / f"{name}.dict"
    words.write_text("\n".join(("#", *_quoted(getattr(module, "WORDS", ())))), encoding="ascii")
    options = [
        f"-max_len={getattr(module, 'MOST_BYTES', MOST_BYTES)}",
        f"-timeout={HANG_S}",
        "-rss_limit_mb=3000",
        "-len_control=20",
        "-print_final_stats=1",
        "-verbosity=1",
        f"-artifact_prefix={found}/",
        f"-dict={words}",
    ]
    folders = [learned, *([corpus / name] if (corpus / name).is_dir() else [])]
    started, left, executions, log, deaths = time.monotonic(), budget, 0, "", 0
    while deaths < MOST_DEATHS:
        log = _child(target, found, [*options, *_of(left), *map(str, folders)])
        deaths += not _forgotten(target, found)
        done = _last(r"stat::number_of_executed_units:\s*(\d+)", log)
        executions += done
        used = time.monotonic() - started
        left = replace(
            budget,
            runs=-1 if budget.runs < 0 else budget.runs - executions,
            seconds=0 if not budget.seconds else max(int(budget.seconds - used), 1),
            seed=left.seed + 1,
        )
        over = (budget.runs >= 0 and left.runs <= 0) or (budget.seconds and left.seconds <= 1)
        if "Done " in log or over or not done:
            break
    (found / LOG).write_text(log[-20000:], encoding="utf-8")
    return Found(
        target,
        executions,
        time.monotonic() - started,
        sum(1 for _ in learned.iterdir()),
        _last(r"cov: (\d+)", log),
        tuple(
            sorted(p for p in found.iterdir() if p.suffix != ".txt" or (not done and p.name == LOG))
        ),
    )


def keep(target: str, corpus: Path, out: Path) -> None:
    """Put the smallest inputs that reach all that was reached into the kept corpus of a target."""
    name = target.rpartition(".")[2]
    kept, learned, merged = corpus / name, out / "corpus" / name, out / "merged" / name
    shutil.rmtree(merged, ignore_errors=True)
    for folder in (kept, merged):
        folder.mkdir(parents=True, exist_ok=True)
    _child(target, out / "found" / name, ["-merge=1", *map(str, (merged, learned, kept))])
    shutil.rmtree(kept)
    kept.mkdir()
    size = 0
    for path in sorted(merged.iterdir(), key=lambda p: (p.stat().st_size, p.name))[:MOST_KEPT]:
        size += path.stat().st_size
        if size <= MOST_KEPT_BYTES:
            shutil.copyfile(path, kept / path.name[:16])


def _forgotten(target: str, found: Path) -> bool:
    """Forget what does not happen in a process of its own; say whether there was any such fault.

    A library that the program reads with in a process apart crashes in that of the search, or is
    left in disorder there by a file before.
    """
    forgotten = False
    for path in [path for path in found.iterdir() if path.suffix != ".txt"]:
        here_too = not path.name.startswith(("crash-", "timeout-", "slow-unit-"))
        call = [sys.executable, "-m", "tests.fuzz.once", target, str(path)]
        with suppress(subprocess.TimeoutExpired):
            if _run([*call, "here-too"] if here_too else call, ALONE_S).returncode != 0:
                continue
            path.unlink()
            path.with_name(f"{path.name}.txt").unlink(missing_ok=True)
            forgotten = True
    return forgotten


def _of(budget: Budget) -> Iterable[str]:
    yield f"-seed={budget.seed}"
    if budget.runs >= 0:
        yield f"-runs={budget.runs}"
    if budget.seconds:
        yield f"-max_total_time={budget.seconds}"


def _child(target: str, found: Path, arguments: Iterable[str]) -> str:
    done = _run([sys.executable, "-m", "tests.fuzz.child", target, str(found), *arguments])
    faults = [line for line in done.stdout.splitlines() if line.startswith("FAULT")]
    print(*faults, sep="\n", end="\n" if faults else "", file=sys.stderr)
    if "Done " not in done.stdout and "MERGE-OUTER: successful" not in done.stdout:
        told = "\n  ".join(done.stdout.splitlines()[-15:])
        print(f"the process died ({done.returncode}):\n  {told}", file=sys.stderr)
    return done.stdout


def _run(call: Sequence[str], seconds: float | None = None) -> subprocess.CompletedProcess[str]:
    with TemporaryDirectory(prefix="tsas-fuzz-", dir=MEMORY if MEMORY.is_dir() else None) as folder:
        return subprocess.run(
            call,
            env=os.environ | {"TMPDIR": folder, "PYTHONHASHSEED": "0"},
            stderr=subprocess.STDOUT,
            stdout=subprocess.PIPE,
            text=True,
            errors="replace",
            check=False,
            timeout=seconds,
        )


def _last(pattern: str, log: str) -> int:
    numbers = re.findall(pattern, log)
    return int(numbers[-1]) if numbers else 0


def _quoted(words: Iterable[bytes]) -> Iterable[str]:
    for word in words:
        yield '"' + "".join(f"\\x{byte:02x}" for byte in word) + '"'
