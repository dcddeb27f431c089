"""The Parquet file of a run, whose checksum fits."""

import hashlib

import numpy as np
import pyarrow as pa

from tests.fuzz.rules import Broken, Scratch, answer
from tests.fuzz.targets.parquet import MOST_BYTES, WORDS, parquet
from tests.fuzz.targets.parquet import seeds as any_parquet
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.run_files import open_run, read_columns, read_recording
from tsas_cli.recordings.writing import columns_of, names_of

__all__ = ["MOST_BYTES", "WORDS", "one", "seeds"]
SHARE = 5
_scratch = Scratch()


def one(data):
    """What is read strictly has a time that increases, and is the same column by column."""
    path = _scratch.file("a.parquet", data)
    run = Run(id="a", file=path.name, sha256=hashlib.sha256(data).hexdigest())
    answer(read_recording, path.parent, run, strict=False)
    answer(read_columns, path)
    whole = answer(read_recording, path.parent, run)
    if whole is not None and not (np.diff(whole.time_s) > 0).all():
        raise Broken("the time does not increase")
    opened = answer(open_run, path.parent, run)
    for name in opened.names if opened is not None else ():
        values = answer(opened.read, name)
        if whole is not None and name in whole.columns and values is not None:
            np.testing.assert_array_equal(values, whole.columns[name])
    listed = answer(names_of, path)
    if listed:
        answer(columns_of, path, listed[:20])


def seeds():
    columns = {"time_s": [0.0, 0.1], "x_in_mm": [1.0, None], "f_in_N": [2.0, 3.0]}
    yield parquet(pa.table(columns), compression="none")
    yield from any_parquet()
