"""Files of a shipped run under names and units of any lab, and the verdict on what is guessed."""

from functools import cache
from pathlib import Path

import numpy as np

from tsas_cli.recordings.canonical import canonical_columns
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.guess.columns import Proposed
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.ingest_map import QUESTION, IngestMap
from tsas_cli.recordings.readers import read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.recordings.units import conversion

SHIPPED = Path(__file__).parents[3] / "datasets" / "paper-groups"
CHANNELS = ("time_s", "x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
RADIUS_MM = 27.1


@cache
def run(step: int = 10) -> dict[str, np.ndarray]:
    """Return group a of the shipped recordings, each `step`th row."""
    columns = next(iter(read_dataset(SHIPPED))).columns
    return {name: columns[name][::step] for name in CHANNELS}


def in_unit(channel: str, unit: str) -> np.ndarray:
    """Return a channel in another unit; an angle and a torque are those of a pulley."""
    radius = RADIUS_MM if unit in ("deg", "rad", "Grad", "N.m", "Nm") else None
    slope, _ = conversion(unit, BY_NAME[channel].unit, pulley_radius_mm=radius)
    return run()[channel] / slope


def write_csv(path: Path, columns: list[tuple[str, np.ndarray]], *, delimiter=",", decimal="."):
    """Write named columns; no line of names where no column has one."""
    names = [name for name, _ in columns]
    lines = [delimiter.join(names)] if any(names) else []
    rows = zip(*(values for _, values in columns), strict=True)
    lines += [delimiter.join(f"{v:.7g}".replace(".", decimal) for v in row) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_run(path: Path, **names: str):
    """Write some channels of the run under other names."""
    return write_csv(path, [(name, run()[channel]) for channel, name in names.items()])


def sources(path: Path) -> dict[str, object]:
    """Return the source that is guessed for each channel."""
    return {c.name: c.entry.get("source") for c in propose([path]).channels}


def verdicts(path: Path, truth: dict[str, str | int]) -> dict[str, str]:
    """Return for each channel of the truth or of the guess: right, open, missing or wrong.

    It is wrong when another column is named, or when what ingest would make of it, a radius given,
    is not the run.
    """
    proposal = propose([path])
    options = ReadOptions.model_validate({k: value for k, (value, _) in proposal.read.items()})
    table = read(path, options, list(truth.values()))
    judged = {c.name: _judged(c.name, c, truth, table, path) for c in proposal.channels}
    return dict.fromkeys(truth, "missing") | judged


def _judged(name, channel: Proposed, truth, table, path) -> str:
    entry = dict(channel.entry)
    if entry.get("source", QUESTION) == QUESTION:
        return "open"
    if entry["source"] != truth.get(name):
        return "wrong"
    if "pulley_radius_mm" in channel.questions:
        entry["pulley_radius_mm"] = RADIUS_MM
    if QUESTION in entry.values():
        return "open"
    some = next(iter(table.columns))
    columns = {
        "time_s": {"rate_Hz": 100},
        "x_in_mm": {"source": some, "unit": "mm"},
        "f_in_N": {"source": some, "unit": "N"},
    }
    columns.pop({"x_out_mm": "x_in_mm", "f_out_N": "f_in_N"}.get(name), None)
    columns[name] = entry
    mapping = IngestMap.model_validate({"dataset": {"name": "m"}, "columns": columns})
    made = canonical_columns(table, mapping, path, Path("map"))[0][name]
    return "right" if np.allclose(made, run()[name], rtol=1e-4, atol=1e-4) else "wrong"


def judged(path, names, **other):
    """Write the run under these names, some values changed, and return what is guessed of it."""
    values = [other.get(channel, run()[channel]) for channel in CHANNELS]
    write_csv(path, list(zip(names, values, strict=True)))
    truth = [name or i for i, name in enumerate(names, start=1)]
    return verdicts(path, dict(zip(CHANNELS, truth, strict=True)))
