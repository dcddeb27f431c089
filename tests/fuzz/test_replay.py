"""What the search has learned, and every input that once broke a rule, is tried in each run."""

import pytest

from tests.fuzz.__main__ import CORPUS, NAMES, target_of
from tests.fuzz.rules import Watch

FOUND = CORPUS.parent / "found"


@pytest.fixture(scope="module")
def watch() -> Watch:
    return Watch()


@pytest.mark.parametrize("name", NAMES)
def test_every_kept_input_is_taken_or_refused(name: str, watch: Watch) -> None:
    target = target_of(name)
    kept = [p for folder in (CORPUS, FOUND) for p in sorted((folder / name).glob("*"))]
    inputs = [*target.seeds(), *(path.read_bytes() for path in kept)]
    assert inputs
    target.one(inputs[0])  # what is loaded and compiled at the first use is written then
    for data in inputs:
        with watch.during():
            target.one(data)
