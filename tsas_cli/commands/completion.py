"""What a shell completes beside options and files; nothing here loads a heavy library."""

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path

import typer

import tsas_cli
from tsas_cli.collection import COLUMNS
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.tracking import SHAPE_NAMES

ABOUT_EFFECTS = {"__init__", "effect"}  # files beside those of the effects
_PLAIN = re.compile(r"[\w@%+:./-]+")  # no shell reads more in it than a word


def effect_names(incomplete: str) -> list[str]:
    """Return the effects that begin so: each is a file."""
    files = (Path(tsas_cli.__file__).parent / "effects").glob("*.py")
    names = sorted({file.stem for file in files} - ABOUT_EFFECTS)
    return [name for name in names if name.startswith(incomplete)]


def controllers(incomplete: str) -> list[str]:
    """Return the lists of controllers that continue what is there."""
    return _continued(("all", *CONTROLLERS), incomplete)


def references(incomplete: str) -> list[str]:
    """Return the shapes of a reference that begin so."""
    return [name for name in SHAPE_NAMES if name.startswith(incomplete)]


def run_ids(context: typer.Context, incomplete: str) -> list[str]:
    """Return the lists of runs that continue what is there, of the dataset that was named.

    A shell puts them into a command as they are, and some evaluate them before: an id that a shell
    would read as more than a word is left out.
    """
    manifests = (Path(word) / "dataset.toml" for word in context.args)
    manifest = next((path for path in manifests if path.is_file()), None)
    if manifest is None:
        return []  # none was named yet
    try:
        text = limits.text_of(manifest, limits.TOML_BYTES)
        limits.toml(text, manifest)
        runs = tomllib.loads(text)["run"]
        ids = [str(run["id"]) for run in runs]
    except (KeyError, TypeError, OSError, ValueError, RecursionError, InputError):
        return []  # what is wrong with it, the command will say
    return _continued([name for name in ids if _PLAIN.fullmatch(name)], incomplete)


def run_columns(incomplete: str) -> list[str]:
    """Return the lists of columns of `tsas runs` that continue what is there."""
    return _continued(COLUMNS, incomplete)


def sort_columns(incomplete: str) -> list[str]:
    """Return the same for sorting, where a minus may stand before a name."""
    return _continued([*COLUMNS, *(f"-{name}" for name in COLUMNS)], incomplete)


def _continued(words: Sequence[str], incomplete: str) -> list[str]:
    """Return the words that fit after the last comma, with what stands before it."""
    before, comma, begun = incomplete.rpartition(",")
    told = before.split(",")
    return [f"{before}{comma}{w}" for w in words if w.startswith(begun) and w not in told]
