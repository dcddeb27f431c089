"""What tests of pages share."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from tests.reporting.made_folders import make_dataset


@contextmanager
def no_curves() -> Iterator[None]:
    """Let pictures have their words and no curves, which take longer than the rest of a page."""

    def empty(_, stream, **__):
        stream.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"/>')

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", empty)
        yield


@pytest.fixture
def undrawn() -> Iterator[None]:
    """Draw no curves in a test."""
    with no_curves():
        yield


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two short runs of a play operator, which no test changes."""
    return make_dataset(tmp_path_factory.mktemp("made") / "dataset", samples=2000)
