"""`tsas runs` over 10,000 manifests: the first call, which reads them, and those after it."""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa

from benchmarks.row import Row
from tsas_cli.recordings.writing import write_parquet
from tsas_cli.support.files import sha256_of

DATASETS = 10_000
RUNS = 2  # in each
DIAGNOSED = 10  # every so many
REPEATS = 9
QUERY = "total_bend_rad > 3 and f_out in channels and started >= 2026-01 and rate_Hz > 10"


def measure() -> Iterator[Row]:
    """Time whole processes: the start of Python and of the program counts."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        make(home / "rigs")
        environment = os.environ | {"TSAS_CACHE_DIR": str(home / "cache")}
        cold = seconds(home, environment)
        warm = [seconds(home, environment) for _ in range(REPEATS)]
        (home / "rigs" / "rig-00" / "00000" / "dataset.toml").touch()
        after = seconds(home, environment)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds(home, environment)
        after_it = resource.getrusage(resource.RUSAGE_CHILDREN)
        start = [seconds(home, environment, "--help") for _ in range(REPEATS)]
    yield Row("manifests", DATASETS, "")
    yield Row("runs", DATASETS * RUNS, "")
    yield Row("first call", cold, "s")
    yield Row("later calls, fastest", min(warm), "s", at_most=1.0)
    yield Row("later calls, median", statistics.median(warm), "s")
    processor = after_it.ru_utime + after_it.ru_stime - spent.ru_utime - spent.ru_stime
    yield Row("a later call, processor time", processor, "s")
    yield Row("one manifest changed", after, "s")
    yield Row("tsas runs --help alone, fastest", min(start), "s")


def make(folder: Path) -> None:
    """Write the datasets of 100 rigs, all with the same short recording."""
    folder.mkdir()
    time_s = np.arange(50) / 100
    columns = {"time_s": time_s, "x_in_mm": np.sin(time_s), "f_out_N": 20 + time_s}
    one = folder.parent / "one.parquet"
    write_parquet(one, pa.table(columns))
    recording, digest = one.read_bytes(), sha256_of(one)
    for number in range(DATASETS):
        dataset = folder / f"rig-{number % 100:02d}" / f"{number:05d}"
        (dataset / "runs").mkdir(parents=True)
        lines = [f'format = 1\nname = "bench-{number}"\nkind = "measured"\n[rig]\ngear_ratio = 5.0']
        for run in range(RUNS):
            (dataset / "runs" / f"{run}.parquet").write_bytes(recording)
            day = 1 + number % 28
            lines.append(
                f'[[run]]\nid = "{run}"\nfile = "runs/{run}.parquet"\nsha256 = "{digest}"\n'
                f"started = 2026-{1 + number % 12:02d}-{day:02d}T09:30:00\n"
                f"total_bend_rad = {number % 5}\npreload_N = 25.0\nsheath_length_mm = 785.4"
            )
        (dataset / "dataset.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
        if number % DIAGNOSED == 0:
            diagnose(dataset, dataset.name)


def diagnose(dataset: Path, name: str) -> None:
    """Write the file of a diagnosis beside a dataset."""
    (dataset / "diagnose").mkdir()
    content = {
        "format": 1,
        "stage": "diagnose",
        "version": "0",
        "dataset": {
            "name": name,
            "folder": "..",
            "hashes": {"dataset.toml": sha256_of(dataset / "dataset.toml")},
        },
        "verdict": "sufficient",
        "reason": "the nominal model is at the noise floor",
    }
    (dataset / "diagnose" / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")


def seconds(home: Path, environment: dict[str, str], *more: str) -> float:
    """Return how long a call takes."""
    call = [sys.executable, "-m", "tsas_cli", "runs", QUERY, "--in", str(home / "rigs"), *more]
    start = time.perf_counter()
    subprocess.run(call, stdout=subprocess.DEVNULL, check=True, env=environment)
    return time.perf_counter() - start
