"""Recordings as files: format 1 written with pyarrow alone, as an outside tool would."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomlkit

from tsas_studies.challenge.rig.motions import Floats, Motion, sine
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

UNITS = {
    "time_s": "s",
    "x_in_mm": "mm",
    "x_out_mm": "mm",
    "f_in_N": "N",
    "f_out_N": "N",
    "motor_speed_rpm": "rpm",
}
DATA_SHEET = {
    "tendon_diameter_mm": 1.2,
    "tendon_modulus_GPa": 60.0,
    "friction_coefficient": 0.125,
    "load_stiffness_N_per_mm": 1.579,
    "turntable_radius_mm": 27.1,
    "gear_ratio": 120.0,
}


@dataclass(frozen=True, eq=False)
class Run:
    """One run to write: its id, its columns, and the conditions for the manifest."""

    id: str
    columns: Mapping[str, Floats]
    conditions: Mapping[str, Any] = field(default_factory=dict)

    @property
    def time_s(self) -> Floats:
        """The times that are written down [s], shape (n,)."""
        return self.columns["time_s"]

    def having(self, **columns: Floats) -> "Run":
        """Return the run with other columns."""
        return replace(self, columns={**self.columns, **columns})


def record(
    rig: Rig,
    motion: Motion | None = None,
    *,
    sensors: Sensors | None = None,
    seed: int = 0,
    distal: Floats | None = None,
) -> dict[str, Floats]:
    """Simulate and measure in one go: columns time_s, x_in_mm, x_out_mm, f_in_N, f_out_N.

    The motion is two periods of the paper's sine and the sensors are `Sensors()` if not given.
    For many seeds of one run keep `clean = simulate(rig, motion)` and call `measure` per seed.
    """
    clean = simulate(rig, motion or sine(), distal=distal)
    return measure(clean, sensors or Sensors(), seed=seed)


def conditions(rig: Rig) -> dict[str, Any]:
    """Return what the manifest tells of a run on this rig, all true."""
    return {
        "sheath_length_mm": rig.sheath_length_mm,
        "total_bend_rad": rig.total_bend_rad,
        "preload_N": rig.preload_N,
        "load": rig.load,
    }


def write_dataset(
    folder: Path,
    runs: Sequence[Run],
    *,
    name: str = "rig",
    description: str = "Made by the virtual rig.",
    data_sheet: Mapping[str, float] | None = None,
    **more: Any,
) -> Path:
    """Write `dataset.toml` and `runs/ID.parquet` into a folder, and return the folder.

    The folder is made where it is missing; files of the same names are replaced. `more` are other
    top-level keys of the manifest (`license`, `source`), `data_sheet` is its [rig] table, Table 1
    of Yang 2025 by default.
    """
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    manifest = {"format": 1, "name": name, "kind": "simulated", "description": description, **more}
    manifest["rig"] = dict(DATA_SHEET if data_sheet is None else data_sheet)
    manifest["run"] = [_write_run(folder, run) for run in runs]
    (folder / "dataset.toml").write_text(tomlkit.dumps(manifest), encoding="utf-8")
    return folder


def _write_run(folder: Path, run: Run) -> dict[str, Any]:
    file = f"runs/{run.id}.parquet"
    write_parquet(folder / file, run.columns)
    digest = hashlib.sha256((folder / file).read_bytes()).hexdigest()
    return {"id": run.id, "file": file, "sha256": digest, **run.conditions}


def write_parquet(path: Path, columns: Mapping[str, Floats]) -> None:
    """Write float64 columns with their units; not-finite values become null."""
    schema = pa.schema(
        [
            pa.field(c, pa.float64(), metadata={"unit": UNITS[c]} if c in UNITS else None)
            for c in columns
        ]
    )
    arrays = [pa.array(v, pa.float64(), mask=~np.isfinite(v)) for v in columns.values()]
    pq.write_table(pa.Table.from_arrays(arrays, schema=schema), path, compression="zstd")
