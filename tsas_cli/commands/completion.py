"""Shell completion of names; no heavy library is loaded."""

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

NO_EFFECTS = {"__init__", "effect"}  # other files among those of the effects
_PLAIN = re.compile(r"[\w@%+:./-]+")  # a single literal word for every shell


def effect_names(incomplete: str) -> list[str]:
    """Return the effects that begin with the text; each is a file."""
    files = (Path(tsas_cli.__file__).parent / "effects").glob("*.py")
    names = sorted({file.stem for file in files} - NO_EFFECTS)
    return [name for name in names if name.startswith(incomplete)]


def controllers(incomplete: str) -> list[str]:
    """Return the lists of controllers that complete the text."""
    return _continued(("all", *CONTROLLERS), incomplete)


def references(incomplete: str) -> list[str]:
    """Return the shapes of a reference that begin with the text."""
    return [name for name in SHAPE_NAMES if name.startswith(incomplete)]


def run_ids(context: typer.Context, incomplete: str) -> list[str]:
    """Return the lists of runs of the dataset in the call that complete the text.

    Shells insert them without quoting, and some evaluate them: an id that is no plain word is left
    out.
    """
    manifests = (Path(word) / "dataset.toml" for word in context.args)
    manifest = next((path for path in manifests if path.is_file()), None)
    if manifest is None:
        return []  # no dataset in the call yet
    try:
        text = limits.text_of(manifest, limits.TOML_BYTES)
        limits.toml(text, manifest)
        runs = tomllib.loads(text)["run"]
        ids = [str(run["id"]) for run in runs]
    except (KeyError, TypeError, OSError, ValueError, RecursionError, InputError):
        return []  # the command reports the fault
    return _continued([name for name in ids if _PLAIN.fullmatch(name)], incomplete)


def run_columns(incomplete: str) -> list[str]:
    """Return the lists of columns of `tsas runs` that complete the text."""
    return _continued(COLUMNS, incomplete)


def sort_columns(incomplete: str) -> list[str]:
    """Return the same for sorting, in which a name may have a minus."""
    return _continued([*COLUMNS, *(f"-{name}" for name in COLUMNS)], incomplete)


def _continued(words: Sequence[str], incomplete: str) -> list[str]:
    """Return the completions of the word after the last comma, with the text before it."""
    before, comma, begun = incomplete.rpartition(",")
    listed = before.split(",")
    return [f"{before}{comma}{w}" for w in words if w.startswith(begun) and w not in listed]
