"""What a shell completes beside options and files; nothing here loads a heavy library."""

import tomllib
from pathlib import Path

import typer

import tsas_cli
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.tracking import SHAPE_NAMES

ABOUT_EFFECTS = ("__init__", "effect")  # files beside those of the effects


def effect_names(incomplete: str) -> list[str]:
    """Return the effects that begin so: each is a file."""
    files = (Path(tsas_cli.__file__).parent / "effects").glob("*.py")
    return [name for name in sorted(f.stem for f in files) if _fits(name, incomplete)]


def controllers(incomplete: str) -> list[str]:
    """Return the lists of controllers that continue what is there."""
    return _continued(("all", *CONTROLLERS), incomplete)


def references(incomplete: str) -> list[str]:
    """Return the shapes of a reference that begin so."""
    return [name for name in SHAPE_NAMES if name.startswith(incomplete)]


def run_ids(context: typer.Context, incomplete: str) -> list[str]:
    """Return the lists of runs that continue what is there, of the dataset that was named."""
    try:
        text = (Path(context.params["dataset"]) / "dataset.toml").read_text(encoding="utf-8")
        ids = [str(run["id"]) for run in tomllib.loads(text)["run"]]
    except (KeyError, TypeError, OSError, ValueError):
        return []  # no dataset yet, or none that could be read
    return _continued(ids, incomplete)


def _fits(name: str, incomplete: str) -> bool:
    return name not in ABOUT_EFFECTS and name.startswith(incomplete)


def _continued(words: "tuple[str, ...] | list[str]", incomplete: str) -> list[str]:
    """Return the words that fit after the last comma, with what stands before it."""
    before, comma, begun = incomplete.rpartition(",")
    told = before.split(",")
    return [f"{before}{comma}{w}" for w in words if w.startswith(begun) and w not in told]
