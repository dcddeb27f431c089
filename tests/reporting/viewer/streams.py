"""Small streams, whole and spoilt."""

from pathlib import Path

import numpy as np
from rerun.blueprint import Blueprint, Tabs

from tsas_cli.reporting.stream.layout import series
from tsas_cli.reporting.stream.recorder import times_of, to_file


def make_stream(path: Path, samples: int = 2000) -> Path:
    """Record a sine and a cosine, in a tab each."""
    time_s = np.arange(samples) / 1000
    with to_file(path, "waves") as recorder:
        for name, wave in (("sine", np.sin), ("cosine", np.cos)):
            recorder.series(name, times_of(time_s), wave(7 * time_s), name, 0x3366CCFF)
        tabs = Tabs(*(series(name, [name]) for name in ("sine", "cosine")))
        recorder.lay_out(Blueprint(tabs, collapse_panels=True))
    return path
