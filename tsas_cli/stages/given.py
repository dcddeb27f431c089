"""What a caller may hand over: a dataset or its folder, a path or its text, a word of a few."""

import math
import os
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from inspect import signature
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from threadpoolctl import threadpool_limits

from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.storage import Address, Location, location_of
from tsas_cli.support.errors import LONGEST_WORD, InputError, nearest

FEW_WORDS = 6  # that an error lists, whatever is near
NAME_BYTES, PATH_BYTES = 255, 4095  # of Linux; macOS allows less
Named = str | Path
Thing = TypeVar("Thing")
Word = TypeVar("Word", bound=str)


def path_of(given: Thing | str, *kinds: type) -> Thing | Path:
    """Return text as a path; a path, None and a value of one of these kinds as they are.

    InputError: it is of another kind.
    """
    named: Thing | Path = Path(_not_empty(given)) if isinstance(given, str) else given
    of_kind((Path, NoneType, *kinds), named)
    return _nameable(named)


def file_of(given: Named) -> Path:
    """Return a path or its text as a path; InputError where it is of another kind."""
    return _nameable(Path(_not_empty(of_kind((str, Path), given))))


def paths_of(given: Named | Iterable[Named], *, least: int = 1) -> list[Path]:
    """Return one path or several as a list; InputError for another kind, or fewer than `least`."""
    return [file_of(each) for each in several_of(given, least)]


def place_of(given: Named | Address) -> Location:
    """Return a local path or an address; InputError where it is of another kind, or no name."""
    return _nameable(location_of(_not_empty(of_kind((str, Path, Address), given))))


def dataset_of(given: Dataset | Named, runs: Iterable[str] | None = None) -> Dataset:
    """Return a dataset, or open that of a folder or an address, with the runs that were asked for.

    InputError: the folder is none, or there is no such run.
    """
    if isinstance(given, Dataset):
        dataset = given
    else:
        place = location_of(_not_empty(of_kind((str, Path, Address, Dataset), given)))
        dataset = read_dataset(_nameable(place))
    return dataset if runs is None else dataset.only(listed(runs))


def one_of(words: Sequence[Word], given: str, name: str) -> Word:
    """Return a word that is among those that are known; InputError: it is not."""
    for word in words:
        if isinstance(given, str) and word == given:  # an array is equal one by one
            return word
    remedy = nearest(given, words)
    few = len(words) <= FEW_WORDS
    raise InputError(
        f"{name} is {given!r}",
        expected=" or ".join(words) if few else "",
        remedy="" if few and remedy.startswith("known") else remedy,
    )


def at_least(least: int, given: int, name: str, *, most: float = math.inf) -> int:
    """Return a whole number that is no less than the least one, and no more than the most.

    InputError: it is.
    """
    if not least <= of_kind((int,), given) <= most:
        wanted = f"{least} or more" if given < least else f"at most {most}"
        raise InputError(f"{name} is {given}", expected=wanted)
    return given


def listed(words: str | Iterable[str]) -> list[str]:
    """Return words as a list, a single one too; InputError where one is no word."""
    return [of_kind((str,), word) for word in several_of(words, 0)]


def several_of(given: Any, least: int = 1) -> list[Any]:
    """Return what is one thing or several as a list; fewer than `least` is an InputError."""
    if isinstance(given, str | Path) or not isinstance(given, Iterable):
        return [given]
    try:
        several = list(given)
    except TypeError:  # an array of no dimension
        return [given]
    if len(several) < least:
        raise InputError("no folder or file is named", expected="one or several")
    return several


def of_kind(kinds: tuple[type, ...], given: Any, name: str = "") -> Any:
    """Return what is of one of these kinds; another one is an InputError, with its name."""
    if isinstance(given, kinds) and (bool in kinds or not isinstance(given, bool)):
        return given
    names = dict.fromkeys(kind.__name__ for kind in kinds if kind is not NoneType)
    what = f"{repr(given)[:LONGEST_WORD]} is of type {type(given).__name__}"
    raise InputError(what, where=name, expected=" or ".join(names))


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that refuses what is of no kind, or no word, that it is annotated with.

    Numbers, and what can be of a kind with parts, the function checks itself. Its products of
    matrices run on one thread.
    """
    hints = get_type_hints(function)
    kinds = {name: _kinds(hint) for name, hint in hints.items()}
    words = {n: get_args(hint) for n, hint in hints.items() if get_origin(hint) is Literal}
    named = signature(function)

    @wraps(function)
    def call(*args: Any, **keywords: Any) -> Any:
        for name, given in named.bind(*args, **keywords).arguments.items():
            if kinds.get(name):
                of_kind(kinds[name], given, name)
            if name in words:
                one_of(words[name], given, name)
        # Threads inside each product of small matrices cost more than they save.
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **keywords)

    return call


def _kinds(hint: Any) -> tuple[type, ...]:
    """Return the classes of an annotation, none where there are others or numbers among them."""
    if get_origin(hint) is Callable:
        return (Callable,)
    kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    if not all(isinstance(kind, type) and kind not in {int, float, Any} for kind in kinds):
        return ()
    return (bool, int, np.bool_) if kinds == (bool,) else kinds


def _not_empty(given: Thing) -> Thing:
    """Return what names something; empty text, as of a variable that is not set, is an InputError.

    It would be the current folder.
    """
    if isinstance(given, str) and not given:
        raise InputError("the path is empty", expected="a file or a folder")
    return given


def _nameable(given: Thing) -> Thing:
    """Return what is no path, or a path that a file can have; another one is an InputError."""
    if isinstance(given, Path):
        try:
            long = any(len(os.fsencode(part)) > NAME_BYTES for part in given.parts)
            invalid = long or len(os.fsencode(given)) > PATH_BYTES or "\0" in str(given)
        except UnicodeEncodeError:
            invalid = True
        if invalid:
            raise InputError(
                "no file can have this name",
                where=f"{str(given)[:60]}…",
                expected=f"text of at most {NAME_BYTES} bytes in a name, none of them zero",
            )
    return given
