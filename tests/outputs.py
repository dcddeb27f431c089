"""Outputs of a stage called "check", with the summary and the checksums that make them its own."""

import json
from contextlib import contextmanager
from pathlib import Path

import pytest

from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_file, new_folder, stage_folder, write_sums

STAGE = "check"


def make_output(path: Path, **texts: str) -> None:
    """Write an earlier output, with these files beside its summary."""
    path.mkdir(parents=True)
    fill(path, **texts)
    write_sums(path)


def fill(folder: Path, **texts: str) -> None:
    """Write a summary and these files into a folder."""
    (folder / "check.json").write_text(json.dumps({"stage": STAGE}))
    for name, text in texts.items():
        (folder / name).write_text(text)


def folder_of(path: Path, *, inputs=(), force=False):
    """Open a new folder as the stage does."""
    return new_folder(path, stage=STAGE, inputs=inputs, force=force)


def file_of(path: Path, *, inputs=(), force=False):
    """Open a new file whose mark is "mine"."""
    return new_file(path, mark=b"mine", inputs=inputs, force=force)


@contextmanager
def written(path: Path, *, inputs=(), force=False, **texts: str):
    """Open a stage's folder with a summary and these files in it."""
    with stage_folder(path, stage=STAGE, inputs=inputs, force=force) as folder:
        fill(folder, **texts)
        yield folder


def write(path: Path, *, force=False) -> None:
    """Write a new output."""
    with folder_of(path, force=force) as folder:
        (folder / "result").write_text("new")


def refused(block, why: str) -> None:
    """Enter a block that is refused before anything in it is done."""
    with pytest.raises(InputError, match=why), block:
        pytest.fail("the block must not run")


def names(folder: Path) -> list[str]:
    """Return the names of what is in a folder."""
    return sorted(path.name for path in folder.iterdir())
