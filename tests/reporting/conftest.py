"""What tests of pages share."""

import pytest
from matplotlib.figure import Figure


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let pictures have their words and no curves, which take longer than the rest of a page."""

    def empty(_, stream, **__):
        stream.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"/>')

    monkeypatch.setattr(Figure, "savefig", empty)
