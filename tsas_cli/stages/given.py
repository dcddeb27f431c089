"""What a caller may hand over: a dataset or its folder, a path or its text, a word of a few."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.storage import Location, location_of
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError, nearest

Named = str | Path
Thing = TypeVar("Thing")
Word = TypeVar("Word", bound=str)


def path_of(given: Thing | str) -> Thing | Path:
    """Return text as a path, and anything else as it is."""
    return Path(given) if isinstance(given, str) else given


def paths_of(given: Named | Iterable[Named]) -> list[Path]:
    """Return one path or several as a list."""
    return [Path(each) for each in ([given] if isinstance(given, str | Path) else given)]


def places_of(given: Named | Iterable[Named]) -> list[Location]:
    """Return one place or several as a list: local paths, or addresses of datasets."""
    return [location_of(each) for each in ([given] if isinstance(given, str | Path) else given)]


def dataset_of(given: Dataset | Named, runs: Iterable[str] | None = None) -> Dataset:
    """Return a dataset, or open that of a folder or an address, with the runs that were asked for.

    Raises
    ------
    InputError
        The folder is none, or there is no such run.
    """
    dataset = given if isinstance(given, Dataset) else read_dataset(location_of(given))
    return dataset if runs is None else dataset.only(listed(runs))


def one_of(words: Sequence[Word], given: str, name: str) -> Word:
    """Return a word that is among those that are known.

    Raises
    ------
    InputError
        It is not.
    """
    for word in words:
        if word == given:
            return word
    raise InputError(
        f"{name} is {given!r}", expected=" or ".join(words), remedy=nearest(given, words)
    )


def at_least(least: int, given: int, name: str) -> int:
    """Return a whole number that is no less than the least one.

    Raises
    ------
    InputError
        It is less.
    """
    if given < least:
        raise InputError(f"{name} is {given}", expected=f"{least} or more")
    return given


def number_of_seeds(given: int) -> int:
    """Return how many seeds are asked for.

    Raises
    ------
    InputError
        There is none, or there are more than anyone waits for.
    """
    if at_least(1, given, "seeds") > limits.SEEDS:
        raise InputError(f"seeds is {given}", expected=f"at most {limits.SEEDS}")
    return given


def listed(words: str | Iterable[str]) -> list[str]:
    """Return words as a list, a single one too."""
    return [words] if isinstance(words, str) else list(words)
