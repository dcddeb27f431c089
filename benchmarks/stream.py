"""Seconds and memory to write a Rerun stream of a million samples on six channels."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa

from benchmarks.row import Row
from benchmarks.timing import Times
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.writing import write_dataset

SAMPLES, RATE_HZ = 1_000_000, 1000.0
CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "motor_speed_rpm", "temperature_C")
REPEATS = 3
WRITE = """
import resource, sys, time
from pathlib import Path
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import write_stream
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
before, start = peak(), time.perf_counter()
write_stream(read_inputs([Path(sys.argv[1])]), Path(sys.argv[2]))
print(time.perf_counter() - start, peak() - before)
"""


def measure() -> Iterator[Row]:
    """Write the stream in a process of its own, for its memory; the fastest of some counts."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = dataset(folder / "dataset")
        found = [written(made, folder / f"{number}.rrd") for number in range(REPEATS)]
        recorded = (made / "runs" / "a.parquet").stat().st_size
        stream = (folder / "0.rrd").stat().st_size
    took, peak = Times(tuple(seconds for seconds, _ in found)), min(found)[1]
    size = f"{SAMPLES:.0e} samples on {len(CHANNELS)} channels"
    yield Row.timed(f"write {size}", took, "s", at_most=3.0)
    yield Row("size of the stream", stream / 1e6, "MB")
    yield Row("size of the recording, as Parquet", recorded / 1e6, "MB")
    yield Row("size of the recording, as arrays", 8e-6 * SAMPLES * (1 + len(CHANNELS)), "MB")
    yield Row("memory beyond the libraries, at its peak", peak / 1e6, "MB")


def dataset(folder: Path) -> Path:
    """Write one run of sines with noise."""
    rng = np.random.default_rng(1)
    time_s = np.arange(SAMPLES) / RATE_HZ
    columns = {
        name: 10.0 * np.sin((1.0 + k) * time_s) + 0.1 * rng.standard_normal(SAMPLES)
        for k, name in enumerate(CHANNELS)
    }
    run = Run(id="a", file="runs/a.parquet", sha256="0" * 64)
    manifest = Manifest(format=1, name="long", kind="simulated", run=(run,))
    folder.mkdir()
    write_dataset(folder, manifest, {"a": pa.table({"time_s": time_s, **columns})})
    return folder


def written(folder: Path, path: Path) -> tuple[float, float]:
    """Write a stream; return the time [s], and by how much the memory grew at most [bytes]."""
    done = subprocess.run(
        [sys.executable, "-c", WRITE, folder, path],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"RERUN": "on"},
    )
    seconds, peak = map(float, done.stdout.split())
    return seconds, peak
