"""The phases of a cycle as the page names, numbers and colours them, the same in every plot."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.records.base import PhaseSegment
from tsas_cli.support.arrays import Floats


@dataclass(frozen=True)
class Phase:
    """One phase: its key in the files, its name on the page, its number beside the curve."""

    key: str
    label: str
    number: str
    colour: str


PHASES = (
    Phase("contraction", "contraction", "1", "contraction"),
    Phase("dead_band_down", "dead band down", "2", "dead-band-down"),
    Phase("loosening", "loosening", "3", "loosening"),
    Phase("dead_band_up", "dead band up", "4", "dead-band-up"),
    Phase("rest", "rest", "", "rest"),
    Phase("unknown", "unknown", "", "unknown"),
)
BY_KEY = {phase.key: phase for phase in PHASES}


def label_of(key: str) -> str:
    """Return the phase's name on the page; a key that is not known is its own name."""
    return BY_KEY[key].label if key in BY_KEY else key


def phase_of_samples(time_s: Floats, segments: Iterable[PhaseSegment]) -> npt.NDArray[np.object_]:
    """Return the phase's key at each sample, shape (n,); "unknown" outside all segments."""
    keys = np.full(time_s.size, "unknown", dtype=object)
    for segment in segments:
        first = np.searchsorted(time_s, segment.start_s, side="left")
        after = np.searchsorted(time_s, segment.end_s, side="right")
        keys[first:after] = segment.phase if segment.phase in BY_KEY else "unknown"
    return keys
