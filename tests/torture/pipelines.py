"""A whole pipeline, `make` in a project, killed with all that it has started."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from tests.torture.bench import faults_of, tree
from tests.torture.trials import TEMPORARY, Tried

AT_MOST_S = 600


def try_pipelines(home: Path, n: int, chance: random.Random) -> Tried:
    """Kill `make` n times at random, each time after the last one has got through."""
    tried = Tried("make")
    project, raw = home / "project", tree(home / "in")
    words = ("init", str(project), "--from", str(home / "in" / "raw"), "--quiet")
    subprocess.run([sys.executable, "-m", "tsas_cli", *words], check=True)
    began = time.monotonic()
    assert _make(project) == 0
    tried.took_s = time.monotonic() - began
    whole = _results(project)
    kept = {path: tree(project / path) for path in ("raw", "bench.toml", "Makefile")}
    reference = home / "reference-make"
    shutil.copytree(project, reference)
    for _ in range(n):
        for path in ("dataset", "result"):
            shutil.rmtree(project / path)
        after_s = chance.uniform(0.0, tried.took_s)
        if _make(project, after_s) == -signal.SIGKILL:
            tried.killed_at_time += 1
        else:
            tried.ended_before += 1
        tried.left_temporaries += len(_temporaries(project))
        faults = [] if _make(project) == 0 else ["the next make fails"]
        faults += [f"{path.name} stays" for path in _temporaries(project)]
        if _results(project) != whole:
            faults.append(f"makes {sorted(_results(project) ^ whole)}")
        for path in ("dataset", "result"):
            faults += faults_of(project / path, tree(reference / path))
        if {path: tree(project / path) for path in kept} != kept or tree(home / "in") != raw:
            faults.append("inputs have changed")
        tried.findings += [f"make, SIGKILL at {after_s:.3f} s: {fault}" for fault in faults]
    return tried


def _results(project: Path) -> set[str]:
    return {
        str(path.relative_to(project))
        for path in project.rglob("*")
        if path.is_file() and not TEMPORARY.search(str(path))
    }


def _temporaries(project: Path) -> list[Path]:
    return [path for path in project.rglob("*") if TEMPORARY.fullmatch(path.name)]


def _make(project: Path, kill_after_s: float | None = None) -> int:
    """Run make as a group of its own; return its exit code, negative for a signal."""
    program = f"TSAS={sys.executable} -m tsas_cli"
    with subprocess.Popen(
        ["make", "-C", str(project), program, "--no-print-directory"],  # noqa: S607
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            _, said = process.communicate(timeout=kill_after_s or AT_MOST_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        else:
            if process.returncode != 0:
                print(said, file=sys.stderr)
    return process.returncode
