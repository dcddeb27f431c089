"""Datasets below a folder."""

from pathlib import Path

import numpy as np
import pyarrow as pa

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.writing import write_dataset

ROWS, RATE_Hz = 101, 50.0


def write(folder: Path, *runs: dict[str, object], channels=("f_out_N",)) -> Path:
    """Write a dataset whose runs have these conditions; each has an id of its own."""
    folder.mkdir(parents=True)
    entries = [
        {"id": f"r{k}", "file": f"runs/r{k}.parquet", "sha256": "0" * 64} | run
        for k, run in enumerate(runs)
    ]
    manifest = Manifest.model_validate(
        {"format": 1, "name": folder.name, "kind": "measured", "run": entries}
        | {"rig": {"gear_ratio": 5.0}}
    )
    time_s = 3 + np.arange(ROWS) / RATE_Hz
    columns = {"time_s": time_s, "x_in_mm": np.sin(time_s)} | dict.fromkeys(channels, time_s)
    write_dataset(folder, manifest, {run.id: pa.table(columns) for run in manifest.run})
    return folder
