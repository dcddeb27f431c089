"""One recording too long for memory: seconds and memory of each stage, and the speed of ingest.

The recording is made on the fly, piece by piece, by the closed form with noise on each channel:
six columns of float64 at 1 kHz. Each stage is a process of its own. `make big` takes 1, 10 and 100
million rows (`TSAS_ROWS`); the folder that they are made in is `TSAS_BIG` or a temporary one.
"""

import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as csv

from benchmarks.row import Row
from tsas_cli.identification.model import data_sheet
from tsas_cli.physics.by_pieces import simulate_pieces
from tsas_cli.physics.ends import DriveInput
from tsas_cli.recordings.manifest import Manifest, RigSheet, Run

ROWS = tuple(int(float(n)) for n in os.environ.get("TSAS_ROWS", "2e6").split(","))
RATE_HZ = 1000.0
PIECE = 1 << 20
MOST_MB = 2000.0
REPEATS = 2
SHEET = {
    "tendon_diameter_mm": 1.2,
    "tendon_modulus_GPa": 60.0,
    "friction_coefficient": 0.125,
    "load_stiffness_N_per_mm": 1.579,
}
CONDITIONS = {"sheath_length_mm": 785.4, "total_bend_rad": 3.1416, "preload_N": 25.0}
UNITS = {
    "time_s": "s",
    "x_in_mm": "mm",
    "x_out_mm": "mm",
    "f_in_N": "N",
    "f_out_N": "N",
    "temperature_C": "°C",
}
STAGES = {
    "ingest": "{csv} --map {map} --out {dataset}",
    "check": "{dataset} --out {folder}/check",
    "calibrate": "{dataset} --out {folder}/calibrate",
    "simulate": "{dataset} --model {folder}/calibrate/model.toml --out {folder}/simulate",
}
MAKE = "import sys; from benchmarks.out_of_core import make; make(sys.argv[1], int(sys.argv[2]))"
PYARROW = """
import sys, time
from pyarrow import csv, parquet
start = time.perf_counter()
with csv.open_csv(sys.argv[1]) as reader:
    with parquet.ParquetWriter(sys.argv[2], reader.schema) as writer:
        for batch in reader:
            writer.write_batch(batch)
print(time.perf_counter() - start)
"""
INGEST = """
import sys, time
import tsas_cli as tsas
from tsas_cli.stages import ingest
start = time.perf_counter()
tsas.ingest(sys.argv[1], map=sys.argv[2], out=sys.argv[3], force=True)
print(time.perf_counter() - start)
"""


@dataclass(frozen=True)
class Cost:
    """What a process takes: time [s], of all cores together [s], memory at its peak [MB]."""

    seconds: float
    cpu_s: float
    peak_MB: float
    said: str


def measure() -> Iterator[Row]:
    """Make each recording, and take it through all stages."""
    for rows in ROWS:
        with tempfile.TemporaryDirectory(dir=os.environ.get("TSAS_BIG")) as name:
            yield from _measured(rows, Path(name))


def _measured(rows: int, folder: Path) -> Iterator[Row]:
    size = f"{rows:.0e} rows"
    places = {
        "csv": folder / "a.csv",
        "map": folder / "map.toml",
        "dataset": folder / "dataset",
        "folder": folder,
    }
    places["map"].write_text(map_text(), encoding="utf-8")
    # In a process of its own: a process begins with the memory of the one that starts it.
    made = taken([sys.executable, "-c", MAKE, places["csv"], rows])
    yield Row(f"{size}: made", made.seconds, "s")
    yield Row(f"{size}: CSV", places["csv"].stat().st_size / 1e9, "GB")
    yield Row(f"{size}: speed of ingest over pyarrow's", ratio(places), "1", at_least=0.5)
    for stage, options in STAGES.items():
        call = [word.format(**places) for word in options.split()]
        cost = taken([sys.executable, "-m", "tsas_cli", stage, *call, "--quiet"])
        yield Row(f"{size}: {stage}", cost.seconds, "s")
        yield Row(f"{size}: {stage}, on all cores together", cost.cpu_s, "s")
        yield Row(f"{size}: {stage}, memory at its peak", cost.peak_MB, "MB", at_most=MOST_MB)
        if stage == "ingest":
            places["csv"].unlink()


def ratio(places: dict[str, Path]) -> float:
    """Return how fast ingest is over pyarrow's own CSV to Parquet, the files read before."""
    peer, own = math.inf, math.inf
    written = places["folder"] / "peer.parquet"
    for _ in range(REPEATS):
        peer = min(peer, float(taken([sys.executable, "-c", PYARROW, places["csv"], written]).said))
        written.unlink()
        call = [sys.executable, "-c", INGEST, places["csv"], places["map"], places["dataset"]]
        own = min(own, float(taken(call).said))
        shutil.rmtree(places["dataset"])
    return peer / own


def taken(call: Sequence[object]) -> Cost:
    """Run a process to its end."""
    start = time.perf_counter()
    process = subprocess.Popen([str(word) for word in call], stdout=subprocess.PIPE, text=True)
    said = process.stdout.read() if process.stdout else ""
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise subprocess.CalledProcessError(process.returncode, process.args)
    peak_MB = used.ru_maxrss * _BYTES_OF_MAXRSS / 1e6
    return Cost(time.perf_counter() - start, used.ru_utime + used.ru_stime, peak_MB, said)


_BYTES_OF_MAXRSS = 1 if sys.platform == "darwin" else 1024


def map_text() -> str:
    """Return the map that tells `tsas ingest` what the recording holds."""
    sheet = "\n".join(f"{name} = {value}" for name, value in SHEET.items())
    conditions = "\n".join(f"{name} = {value}" for name, value in CONDITIONS.items())
    columns = "\n".join(
        f'[columns.{name}]\nsource = "{name}"\nunit = "{unit}"' for name, unit in UNITS.items()
    )
    head = '[dataset]\nname = "big"\nkind = "simulated"'
    return f"{head}\n[rig]\n{sheet}\n{columns}\n[run]\n{conditions}\n"


def make(path: str, rows: int) -> None:
    """Write a recording of so many rows as CSV, a piece at a time."""
    run = Run(id="a", file="runs/a.parquet", sha256="0" * 64, **CONDITIONS)
    manifest = Manifest(format=1, name="big", kind="simulated", rig=RigSheet(**SHEET), run=(run,))
    rig = data_sheet(manifest).rig(run)
    rng = np.random.default_rng(1)
    schema = pa.schema([(name, pa.float64()) for name in UNITS])
    with csv.CSVWriter(path, schema) as writer:
        times = (np.arange(k, min(k + PIECE, rows)) / RATE_HZ for k in range(0, rows, PIECE))
        drives = (DriveInput(motion(time_s), time_s=time_s) for time_s in times)
        done = 0
        for answer in simulate_pieces(rig, drives):
            n = answer.f_in_N.size
            values = {
                "time_s": np.arange(done, done + n) / RATE_HZ,
                "x_in_mm": answer.x_in_mm + 0.002 * rng.standard_normal(n),
                "x_out_mm": answer.x_out_mm + 0.002 * rng.standard_normal(n),
                "f_in_N": answer.f_in_N + 0.05 * rng.standard_normal(n),
                "f_out_N": answer.f_out_N + 0.05 * rng.standard_normal(n),
                "temperature_C": 20.0 + 0.1 * rng.standard_normal(n),
            }
            columns = {name: np.round(column, 6) for name, column in values.items()}
            writer.write_table(pa.table(columns))
            done += n


def motion(time_s: np.ndarray) -> np.ndarray:
    """Return two sines of the drive, whose strokes nest [mm]."""
    return 6.0 + 5.0 * np.sin(1.4 * time_s) + 1.5 * np.sin(4.6 * time_s)
