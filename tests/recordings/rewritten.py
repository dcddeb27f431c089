"""Another file for the run of a dataset, with its checksum in the manifest."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.files import sha256_of


def rewrite(folder: Path, content: pa.Table | bytes, **how: int) -> Run:
    """Write a table or bytes in the place of the only run, and return its entry."""
    (run,) = read_dataset(folder).runs
    path, manifest = folder / run.file, folder / "dataset.toml"
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        pq.write_table(content, path, **how)
    manifest.write_text(manifest.read_text().replace(run.sha256, sha256_of(path)))
    return read_dataset(folder).runs[0]
