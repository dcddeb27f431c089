"""Streams read back, and folders of stages with what a stream shows beside the JSON."""

from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pyarrow as pa
from rerun.blueprint import Blueprint, Tabs, View
from rerun.chunk import RrdReader

from tests.reporting.made_diagnoses import make_diagnosis, write_predictions
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import write_stream
from tsas_cli.reporting.stream.layout import series
from tsas_cli.reporting.stream.recorder import times_of, to_file

MODEL = """format = 1
[parameters.friction_coefficient]
value = 0.125
unit = '1'
stderr = 0.001
interval_low = 0.123
interval_high = 0.127
at_bound = false
origin = "fitted"
"""


@dataclass
class Read:
    """One entity: its times [ns] on each timeline, and by component a list of one list a row."""

    times: dict[str, list[np.ndarray]] = field(default_factory=lambda: defaultdict(list))
    rows: dict[str, list[list]] = field(default_factory=lambda: defaultdict(list))
    chunks: list[int] = field(default_factory=list)
    static: dict[str, list] = field(default_factory=dict)

    def at(self, timeline: str = "t") -> np.ndarray:
        """Return the times of all rows [ns], shape (n,)."""
        return np.concatenate(self.times[timeline])

    @property
    def scalars(self) -> np.ndarray:
        """Return the samples of a series, NaN where there is a gap, shape (n,)."""
        return np.array([row[0] if row else np.nan for row in self.rows["Scalars:scalars"]])


def views(part) -> list[View]:
    """Return all views of a part of a layout."""
    return [part] if isinstance(part, View) else [v for one in part.contents for v in views(one)]


def shown(view: View) -> list[str]:
    """Return the paths of the entities that a view names."""
    contents = [view.contents] if isinstance(view.contents, str) else view.contents
    return [expression.removeprefix("+ ").removesuffix("/**") for expression in contents]


def read(path: Path) -> dict[str, Read]:
    """Return all entities of a stream by path."""
    found: dict[str, Read] = defaultdict(Read)
    for chunk in RrdReader(path).stream():
        batch, entity = chunk.to_record_batch(), found[chunk.entity_path]
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            if name == "rerun.controls.RowId":
                continue
            if name in chunk.timeline_names:
                entity.times[name].append(column.cast(pa.int64()).to_numpy())
            elif chunk.is_static:
                entity.static[name] = column.to_pylist()[0]
            else:
                entity.rows[name] += column.to_pylist()
        if not chunk.is_static:
            entity.chunks.append(chunk.num_rows)
    return dict(found)


def stream(folder: Path, *stages: Path) -> dict[str, Read]:
    """Write the stream of stages into a folder; return its entities."""
    write_stream(read_inputs(list(stages)), folder / "s.rrd")
    return read(folder / "s.rrd")


def make_diagnosed(dataset: Path, folder: Path, verdict: str = "named", **more) -> Path:
    """Write what `tsas diagnose` would: by 2 N the nominal model is off, the extended one not."""
    make_diagnosis(dataset, folder, verdict, **more)
    (folder / "model-extended.toml").write_text(MODEL, encoding="utf-8")
    return write_predictions(dataset, folder, lambda *_: -2.0, channels=("f_in",))


def make_stream(path: Path, samples: int = 2000) -> Path:
    """Record a sine and a cosine, in a tab each."""
    time_s = np.arange(samples) / 1000
    with to_file(path, "waves") as recorder:
        for name, wave in (("sine", np.sin), ("cosine", np.cos)):
            recorder.series(name, times_of(time_s), wave(7 * time_s), name, 0x3366CCFF)
        tabs = Tabs(*(series(name, [name]) for name in ("sine", "cosine")))
        recorder.lay_out(Blueprint(tabs, collapse_panels=True))
    return path
