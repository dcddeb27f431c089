"""What every stage writes about itself and about what it read."""

import os
from pathlib import Path
from typing import Any

from tsas_cli import __version__
from tsas_cli.recordings.dataset import Dataset


def header(stage: str, dataset: Dataset, out: Path) -> dict[str, Any]:
    """Return the first keys of a stage's JSON; the dataset's folder is told relative to `out`."""
    folder = os.path.relpath(dataset.folder.resolve(), out.resolve())
    return {
        "format": 1,
        "stage": stage,
        "version": __version__,
        "dataset": {
            "name": dataset.manifest.name,
            "folder": Path(folder).as_posix(),
            "hashes": dataset.hashes(),
        },
    }
