"""How the page names effects, signals, channels and phases, the same in every plot."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.signals import SIGNALS
from tsas_cli.effects import EFFECTS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.diagnosis import NamedCause
from tsas_cli.support.arrays import Floats

X_IN, TENSIONS = "x_in_mm", ("f_in_N", "f_out_N")
EFFECT = {effect.name: effect for effect in EFFECTS}
_SIGNALS = SIGNALS | {"phase": ("phase of the cycle", "")}  # what a residual is shown over
PHASES = {  # by their keys in the files, the numbers beside the curve
    "contraction": "1",
    "dead_band_down": "2",
    "loosening": "3",
    "dead_band_up": "4",
    "rest": "",
    "unknown": "",
}


def title_of(name: str) -> str:
    """Return an effect's title, its name where the catalogue has none."""
    return EFFECT[name].title if name in EFFECT else name


def within(title: str) -> str:
    """Return a title as it stands within a sentence.

    >>> within("Compliance of the drive")
    'compliance of the drive'
    """
    return title[:1].lower() + title[1:]


def heading_of(cause: NamedCause) -> str:
    """Return a cause's title, with its rival or the number of its rivals."""
    title = cause.title or title_of(cause.effect)
    if not cause.rivals:
        return title
    if len(cause.rivals) == 1:
        return f"{title} (or {within(title_of(cause.rivals[0]))})"
    return f"{title} (or one of {len(cause.rivals)} others)"


def sentence_of(name: str) -> str:
    """Return the first sentence on an effect, empty where the catalogue has none."""
    return EFFECT[name].sentence if name in EFFECT else ""


def in_words(name: str) -> str:
    """Return what a column or a signal means in a few words; any other text as it is.

    >>> in_words("f_in_N"), in_words("direction"), in_words("my_column")
    ('tension at the drive', 'direction', 'my_column')
    """
    return _meaning(name)[0]


def at_axis(name: str) -> str:
    """Return the words with the unit in brackets, where there is one.

    >>> at_axis("f_in_N"), at_axis("phase")
    ('tension at the drive [N]', 'phase of the cycle')
    """
    words, unit = _meaning(name)
    return f"{words} [{unit}]" if unit else words


def quantity_of(column: str) -> str:
    """Return a column's name without its unit.

    >>> quantity_of("f_in_N")
    'f_in'
    """
    return column.rsplit("_", 1)[0]


def _meaning(name: str) -> tuple[str, str]:
    if column := BY_NAME.get(name):
        return column.meaning.split(",")[0], column.unit
    return _SIGNALS.get(name, (name, ""))


def label_of(key: str) -> str:
    """Return the phase's name on the page; a key that is not known is its own name."""
    return key.replace("_", " ") if key in PHASES else key


def role_of_phase(key: str) -> str:
    """Return the role of a phase's colour."""
    return key.replace("_", "-")


def phase_of_samples(time_s: Floats, segments: Iterable[PhaseSegment]) -> npt.NDArray[np.object_]:
    """Return the phase's key at each sample, shape (n,); "unknown" outside all segments."""
    keys = np.full(time_s.size, "unknown", dtype=object)
    for segment in segments:
        first = np.searchsorted(time_s, segment.start_s, side="left")
        after = np.searchsorted(time_s, segment.end_s, side="right")
        keys[first:after] = segment.phase if segment.phase in PHASES else "unknown"
    return keys
