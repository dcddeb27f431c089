"""A recording whose columns a guess names without a question."""

from pathlib import Path

from tests.recordings.guess.rig_files import CHANNELS, run, write_csv

NAMES = ("Time [s]", "Input position [mm]", "Output position [mm]", "Force in [N]", "Force out [N]")


def recorded(path: Path, step: int = 20) -> Path:
    """Write a run as CSV, one of so many samples."""
    path.parent.mkdir(exist_ok=True)
    columns = [(name, run(step)[c]) for c, name in zip(CHANNELS, NAMES, strict=True)]
    return write_csv(path, columns)
