"""Seconds and size of the tendon's pictures of twelve seconds, with two models."""

import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.row import Row
from benchmarks.timing import Times
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.physics.ends import DriveInput
from tsas_cli.recordings.manifest import Run
from tsas_cli.reporting.stream.opened import to_file
from tsas_cli.reporting.stream.sources import EXTENDED, NOMINAL
from tsas_cli.reporting.stream.tendon.along import record_along
from tsas_cli.reporting.stream.tendon.band import record_band
from tsas_cli.reporting.stream.tendon.followed import follow
from tsas_cli.reporting.stream.tendon.scene import record_scene

REPEATS = 5
TIME_S = np.arange(0.0, 4.0 * math.pi, 1e-3)
NOMINAL_VALUES = {
    "friction_coefficient": (0.125, "1"),
    "load_stiffness_N_per_mm": (1.579, "N/mm"),
    "tendon_stiffness_N": (67858.0, "N"),
}
FREE = {"free_tendon.proximal_length_mm": (150.0, "mm")}
RUN = Run(
    id="a",
    file="a.parquet",
    sha256="0" * 64,
    sheath_length_mm=785.4,
    total_bend_rad=math.pi,
    preload_N=25.0,
)


def measure() -> Iterator[Row]:
    """Follow and record two periods of group a of the source paper; the fastest counts."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "s.rrd"
        took = Times(tuple(recorded(path) for _ in range(REPEATS)))
        size = path.stat().st_size
    yield Row.timed("12.6 s of tendon, two models", took, "s", at_most=0.5)
    yield Row("their size", size / 1e6, "MB", at_most=5.0)


def recorded(path: Path) -> float:
    """Follow and record the tendon; return the time [s]."""
    x_in = 10.0 - 10.0 * np.cos(TIME_S)
    drive = DriveInput(x_in, time_s=TIME_S)
    models = {NOMINAL: model(NOMINAL_VALUES), EXTENDED: model(NOMINAL_VALUES | FREE)}
    start = time.perf_counter()
    tendons = follow(RUN, TIME_S, drive, models, [25.0 + 2.9 * x_in])
    path.unlink(missing_ok=True)
    with to_file(path, "tendon") as recorder:
        record_scene(recorder, ("space",), tendons)
        record_along(recorder, ("along",), tendons)
        record_band(recorder, ("dead-band",), tendons, None)
    return time.perf_counter() - start


def model(values: dict[str, tuple[float, str]]) -> Model:
    """Return a model with these values."""
    return Model(tuple(Estimate(name, v, unit, "default") for name, (v, unit) in values.items()))
