"""What a hostile case is: how its files are made, the call that meets them, and what that says."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.writing import write_dataset

MAP = """
[dataset]
name = "x"
[columns.time_s]
source = "t"
unit = "s"
[columns.x_in_mm]
source = "x"
unit = "mm"
[columns.f_in_N]
source = "f"
unit = "N"
"""


TABLE = "t,x,f\n" + "".join(f"{i},{i % 7},{i % 5}\n" for i in range(9))
Make = Callable[[Path], list[object]]  # writes files into a folder and returns the call


@dataclass(frozen=True)
class Case:
    """A call that ends with one line that holds `says`; without `says` it ends well."""

    name: str
    make: Make
    says: str


def cases(of: dict[str, dict[str, Make]]) -> tuple[Case, ...]:
    """Return the cases by what is said of them, and by name."""
    return tuple(Case(name, make, says) for says, made in of.items() for name, make in made.items())


class Evil:
    """What leaves a mark where it is unpickled."""

    def __init__(self, folder: Path) -> None:
        self.mark = folder / "touched"

    def __reduce__(self) -> tuple[object, ...]:
        return (Path.touch, (self.mark,))


def columns(rows: int = 400) -> dict[str, np.ndarray]:
    time_s = np.arange(rows) / 100.0
    x = 10.0 - 10.0 * np.cos(2.0 * time_s)
    return {"time_s": time_s, "x_in_mm": x, "f_in_N": 25.0 + 2.0 * x}


def dataset(folder: Path, ids: tuple[str, ...] = ("a",)) -> Path:
    """Write a small honest dataset."""
    folder.mkdir(parents=True, exist_ok=True)
    runs = [{"id": i, "file": f"runs/{n}.parquet", "sha256": "0" * 64} for n, i in enumerate(ids)]
    manifest = Manifest(format=1, name="bench", kind="measured", run=runs)
    write_dataset(folder, manifest, {i: pa.table(columns()) for i in ids})
    return folder


def manifest_text(file: str = "runs/0.parquet", run: str = "a", digest: str = "0" * 64) -> str:
    return (
        'format = 1\nname = "x"\nkind = "measured"\n'
        f"[[run]]\nid = {json.dumps(run)}\nfile = {json.dumps(file)}\nsha256 = {digest!r}\n"
    )


def around(folder: Path, file: Path) -> Path:
    """Make a dataset of one Parquet file, with its right checksum."""
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    (folder / "dataset.toml").write_text(manifest_text(file.name, digest=digest))
    return folder


def ingesting(file: Path, mapping: str = MAP) -> list[object]:
    """Return the call that ingests one file with a map that takes t, x and f."""
    path = file.parent / "map.toml"
    path.write_text(mapping, encoding="utf-8")
    return ["ingest", file, "--map", path, "--out", file.parent / "out"]


def guessing(file: Path) -> list[object]:
    return ["ingest", file, "--guess"]
