"""Every kept input, and some of each changed at random in the same way, is tried in each run."""

import random
import sys
from collections.abc import Iterator
from itertools import cycle, islice
from types import ModuleType

import pytest

from tests.fuzz.__main__ import CORPUS, NAMES, target_of
from tests.fuzz.rules import Watch
from tests.fuzz.search import MOST_BYTES

FOUND = CORPUS.parent / "found"
CHANGED = 20  # of a target with a share of one


@pytest.fixture(scope="module")
def watch() -> Iterator[Watch]:
    """Modules that an input is the first to need are not written down."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "dont_write_bytecode", True)
        yield Watch()


@pytest.fixture(scope="module", params=NAMES)
def target(request: pytest.FixtureRequest) -> ModuleType:
    return target_of(request.param)


@pytest.fixture(scope="module")
def inputs(target: ModuleType) -> list[bytes]:
    """What the target begins with, and what is kept of its searches."""
    name = target.__name__.rpartition(".")[2]
    kept = [p for folder in (CORPUS, FOUND) for p in sorted((folder / name).glob("*"))]
    inputs = [*target.seeds(), *(path.read_bytes() for path in kept)]
    target.one(inputs[0])  # what is loaded and compiled at the first use is written then
    return inputs


def test_every_kept_input_is_taken_or_refused(
    target: ModuleType, inputs: list[bytes], watch: Watch
) -> None:
    for data in inputs:
        with watch.during():
            target.one(data)


def test_a_changed_input_is_taken_or_refused(
    target: ModuleType, inputs: list[bytes], watch: Watch, monkeypatch: pytest.MonkeyPatch
) -> None:
    atheris = pytest.importorskip("atheris")
    chance = random.Random(1)  # noqa: S311 # not a secret

    def damaged(data: bytes, most: int, _: int = 0) -> bytes:
        """Write a few random bytes into the data, over some of it or in between."""
        begin, end = sorted(chance.randrange(len(data) + 1) for _ in range(2))
        end = chance.choice((begin, min(begin + 4, len(data)), end))
        return (data[:begin] + chance.randbytes(chance.randrange(5)) + data[end:])[:most]

    monkeypatch.setattr(atheris, "Mutate", damaged)  # which the fuzzer alone can call
    change = getattr(target, "mutate", damaged)
    most = getattr(target, "MOST_BYTES", MOST_BYTES)
    for seed, data in enumerate(islice(cycle(inputs), max(4, round(CHANGED * target.SHARE)))):
        with watch.during():
            target.one(change(data, most, seed))
