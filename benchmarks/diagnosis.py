"""How long a diagnosis takes, how much memory it needs, and where the time goes.

Four runs of 20 s at 500 Hz with the full catalogue: nothing hidden, an effect that the closed form
holds, effects that need the slip chain, and two at once, from a seed for building.
"""

import cProfile
import os
import pstats
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.row import Row
from tsas_cli.stages.diagnose import diagnose
from tsas_cli.support.files import read_json
from tsas_studies.challenge.cases import cases
from tsas_studies.challenge.make import make

SEED = 5
CASES = (
    "nothing 1",
    "free_tendon, size 1",
    "presliding, size 1",
    "stribeck_friction, size 1",
    "bend_drift and drive_compliance",
)
RATE_HZ = 500.0
PLANS = ("further_runs.py", "plan.py")
LONGEST_S, LARGEST_MB = 30.0, 2048.0
# Parts of a diagnosis by file and function; what a planned experiment calls of them is the plan's.
PARTS = {
    "reading and conditioning": ("prepared.py", "prepare"),
    "fit of the nominal model": ("joint_fit.py", "solve_fit"),
    "screening": ("screening.py", "screen"),
    "fits": ("extension.py", "fit"),
    "held-out squares": ("held_out.py", "held_out_squares"),
    "remainder": ("remainder.py", "remainder"),
    "next experiment": ("next_experiment.py", "next_experiment"),
}


def measure() -> Iterator[Row]:
    """Time each case in a process of its own, and all of them by part in this one."""
    with tempfile.TemporaryDirectory() as folder:
        chosen = [case for case in cases(SEED) if case.name in CASES]
        make(Path(folder), chosen, rate_Hz=RATE_HZ)
        made = sorted(Path(folder).glob("cases/*/dataset"))
        call(made[0], Path(folder) / "first")  # compiles what no cache holds yet
        for k, dataset in enumerate(made):
            seconds, megabytes, verdict = call(dataset, Path(folder) / f"out-{k}")
            yield Row(f"case {k + 1}, {verdict}", seconds, "s", at_most=LONGEST_S)
            yield Row(f"case {k + 1}, memory at most", megabytes, "MB", at_most=LARGEST_MB)
        yield from by_part(made, Path(folder))


def call(dataset: Path, out: Path) -> tuple[float, float, str]:
    """Return how long `tsas diagnose` takes, its largest memory [MB], and its verdict."""
    line = [sys.executable, "-m", "tsas_cli", "diagnose", str(dataset), "--out", str(out), "-q"]
    start = time.perf_counter()
    process = subprocess.Popen(line)
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    if status != 0:
        raise SystemExit(f"{' '.join(line)} ended with {os.waitstatus_to_exitcode(status)}")
    verdict = read_json(out / "diagnosis.json")["verdict"]
    return seconds, used.ru_maxrss / 1024.0, str(verdict)


def by_part(made: list[Path], folder: Path) -> Iterator[Row]:
    """Profile all cases together and yield what share of the time each part takes."""
    profile = cProfile.Profile()
    start = time.perf_counter()
    profile.enable()
    for k, dataset in enumerate(made):
        diagnose(dataset, out=folder / f"profiled-{k}")
    profile.disable()
    whole = time.perf_counter() - start
    seconds = dict.fromkeys(PARTS, 0.0)
    for (file, _, function), figures in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        for part, place in PARTS.items():
            if (Path(file).name, function) == place:
                callers = figures[4].items()
                seconds[part] += sum(f[3] for at, f in callers if Path(at[0]).name not in PLANS)
    for part, spent in seconds.items():
        yield Row(f"share of {part}", 100.0 * spent / whole, "%")
    yield Row("share of all else", 100.0 * (1.0 - sum(seconds.values()) / whole), "%")
