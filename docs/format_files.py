"""The small files of docs/files.md: two seconds of one stroke, in every format."""

import json
from pathlib import Path

import numpy as np

from tests.recordings.readers import matlab_files

TIME_S = np.arange(401) / 200
X_IN_MM = np.round(10.0 * (1.0 - np.cos(np.pi * TIME_S)), 3)
F_IN_N = np.round(25.0 + 2.3 * X_IN_MM, 2)
F_OUT_N = np.round(25.0 + 1.5 * X_IN_MM, 2)


def csv(path: str) -> None:
    """Write semicolons, decimal commas, a comment, a line of names and one of units."""
    lines = ["% bench 42, 3 March; preload = 25 N", "Zeit;Weg;Kraft;Kraft Last", "ms;mm;N;lbf"]
    rows = zip(1e3 * TIME_S, X_IN_MM, F_IN_N, F_OUT_N / 4.4482216, strict=True)
    lines += [";".join(f"{value:.2f}" for value in row).replace(".", ",") for row in rows]
    Path(path).write_text("\n".join(lines) + "\n", encoding="cp1252")


def controldesk(path: str) -> None:
    """Write a capture as ControlDesk exports it."""
    model = "Model Root"
    channels = [
        (f'"{model}/Encoder/Out1"', X_IN_MM, "mm", 1),
        (f'"{model}/Force in/Out1"', F_IN_N, "N", 1),
        (f'"{model}/Force out/Out1"', F_OUT_N, "N", 1),
    ]
    matlab_files.save_5(Path(path), capture=matlab_files.controldesk([TIME_S], channels))


def matlab_5(path: str) -> None:
    """Write a vector, a matrix and a struct."""
    matlab_files.save_5(Path(path), t=TIME_S, force=np.c_[F_IN_N, F_OUT_N], drive={"x": X_IN_MM})


def matlab_73(path: str) -> None:
    """Write the same as HDF5."""

    def fill(file: object) -> None:
        matlab_files.numbers(file, "t", TIME_S)
        matlab_files.numbers(file, "force", np.c_[F_IN_N, F_OUT_N])
        matlab_files.numbers(matlab_files.struct(file, "drive"), "x", X_IN_MM)

    matlab_files.save_73(Path(path), fill)


def mdf(path: str) -> None:
    """Write MDF 4 with a slower group for the load."""
    from asammdf import MDF, Signal

    with MDF(version="4.10") as file:
        file.append(
            [
                Signal(X_IN_MM, TIME_S, name="Drive.Position", unit="mm"),
                Signal(F_IN_N, TIME_S, name="Drive.Force", unit="N"),
            ]
        )
        file.append([Signal(F_OUT_N[::4], TIME_S[::4], name="Load.Force", unit="N")])
        file.save(path)


def json_table(path: str) -> None:
    """Write names beside rows."""
    rows = np.c_[TIME_S, X_IN_MM, F_IN_N, F_OUT_N].tolist()
    content = {"preload": "25 N", "columns": ["t", "x", "f1", "f2"], "data": rows}
    Path(path).write_text(json.dumps(content), encoding="utf-8")


def parquet(path: str) -> None:
    """Write columns with the unit in their metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {"t": (TIME_S, "s"), "x": (X_IN_MM, "mm"), "f1": (F_IN_N, "N"), "f2": (F_OUT_N, "N")}
    fields = [
        pa.field(name, pa.float64(), metadata={"unit": u}) for name, (_, u) in columns.items()
    ]
    arrays = [values for values, _ in columns.values()]
    pq.write_table(pa.table(arrays, schema=pa.schema(fields)), path)
