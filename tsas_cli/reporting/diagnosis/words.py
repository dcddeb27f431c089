"""How the page names effects and signals."""

from tsas_cli.effects import EFFECTS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records.diagnosis import NamedCause
from tsas_cli.reporting.channels import called

EFFECT = {effect.name: effect for effect in EFFECTS}
_SIGNALS = {  # in words, and the unit
    "speed_mm_per_s": ("speed of the drive", "mm/s"),
    "travel_since_reversal_mm": ("travel of the drive since it turned", "mm"),
    "time_s": ("time in the run", "s"),
    "direction": ("direction of the drive", ""),
    "phase": ("phase of the cycle", ""),
    "run": ("run", ""),
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
    """Return a cause's title, with its rival where there is one, or how many there are."""
    title = cause.title or title_of(cause.effect)
    if not cause.rivals:
        return title
    if len(cause.rivals) == 1:
        return f"{title}, or {within(title_of(cause.rivals[0]))}"
    return f"{title}, or one of {len(cause.rivals)} others"


def sentence_of(name: str) -> str:
    """Return the first sentence on an effect, empty where the catalogue has none."""
    return EFFECT[name].sentence if name in EFFECT else ""


def signal_in_words(name: str) -> str:
    """Return what a signal is; a text that is no known name stays as it is."""
    if name in _SIGNALS:
        return _SIGNALS[name][0]
    return called(name)


def signal_at_axis(name: str) -> str:
    """Return the words with the unit in brackets, where there is one."""
    own = _SIGNALS[name][1] if name in _SIGNALS else ""
    unit = own or (BY_NAME[name].unit if name in BY_NAME else "")
    return signal_in_words(name) + (f" [{unit}]" if unit else "")
