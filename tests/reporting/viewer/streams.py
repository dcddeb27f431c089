"""Small streams, whole and spoilt."""

from pathlib import Path

import numpy as np
from rerun.blueprint import Tabs

from tsas_cli.reporting.stream.opened import to_file
from tsas_cli.reporting.stream.recorder import times_of
from tsas_cli.reporting.stream.views import laid_out, series


def make_stream(path: Path, samples: int = 2000) -> Path:
    """Record a sine and a cosine, in a tab each."""
    time_s = np.arange(samples) / 1000
    with to_file(path, "waves") as recorder:
        for name, wave in (("sine", np.sin), ("cosine", np.cos)):
            recorder.line((name,), name, 0x3366CCFF)
            recorder.scalars((name,), times_of(time_s), wave(7 * time_s))
        recorder.lay_out(laid_out(Tabs(*(series(name, [(name,)]) for name in ("sine", "cosine")))))
    return path
