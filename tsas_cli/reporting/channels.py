"""How the page names a channel: in words, and at an axis."""

from tsas_cli.recordings.columns import BY_NAME


def in_words(name: str) -> str:
    """Return what a canonical column means, in a few words.

    >>> in_words("f_in_N")
    'tension at the drive'
    """
    return BY_NAME[name].meaning.split(",")[0]


def called(name: str) -> str:
    """Return what a column means in a few words; of one that is not canonical its name."""
    return in_words(name) if name in BY_NAME else name


def at_axis(name: str) -> str:
    """Return the words with the unit in brackets.

    >>> at_axis("f_in_N")
    'tension at the drive [N]'
    """
    return f"{in_words(name)} [{BY_NAME[name].unit}]"
