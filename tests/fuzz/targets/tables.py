"""Known numbers in any layout of text, JSON and Parquet, which have to come back bit by bit."""

import random

from hypothesis import given, settings

from tests.fuzz.rules import Scratch
from tests.recordings.readers.any_table import Known, check, plain_tables
from tsas_cli.recordings.readers import delimited, json_table, parquet  # noqa: F401 # instrumented

MOST_BYTES = 4000
SHARE = 1
_scratch = Scratch()


@settings(database=None, deadline=None)
@given(known=plain_tables())
def _holds(known: Known) -> None:
    check(known, _scratch.folder)


def one(data):
    """The bytes are what the table is drawn with."""
    _holds.hypothesis.fuzz_one_input(data)  # type: ignore[attr-defined]


def seeds():
    for seed in range(20):
        yield random.Random(seed).randbytes(1000)  # noqa: S311 # not a secret
