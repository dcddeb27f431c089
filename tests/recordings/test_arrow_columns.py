"""Columns between Arrow and NumPy, as pyarrow itself takes them over."""

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pytest

from tsas_cli.recordings.parquet_files import column_of, floats_from

NAN = float("nan")


@pytest.mark.parametrize(
    "column",
    [
        pa.chunked_array([], pa.float64()),
        pa.chunked_array([[], []], pa.float64()),
        pa.chunked_array([[1.5, -2.0], [3.0]]),
        pa.chunked_array([[None, 1.0], [], [NAN, 2.0, None]]),
        pa.chunked_array([[1, None, 3]], pa.int16()),
        pa.chunked_array([pa.array([0.0, None, *range(20), None])]).slice(1, 19),
        pa.chunked_array([pa.array([0.0, None, *range(20), None]).slice(3, 19)]),
        pa.chunked_array([[None, None]], pa.float64()),
    ],
)
def test_numbers_are_those_that_pyarrow_gives(column):
    wanted = column.cast(pa.float64()).to_numpy()
    np.testing.assert_array_equal(floats_from(column), wanted)


@pytest.mark.parametrize("size", [0, 1, 7, 8, 9, 1000])
@pytest.mark.parametrize("gaps", [False, True])
def test_columns_are_those_that_pyarrow_makes(size, gaps):
    values = np.random.default_rng(size).standard_normal(size)
    if gaps:
        values[::3] = NAN
    made = column_of(values)
    made.validate(full=True)
    assert made.equals(pa.array(values, from_pandas=True))
    assert made.null_count == np.isnan(values).sum()
    assert column_of(np.stack([values, values], axis=1)[:, 0]).equals(made)


def test_text_is_refused():
    with pytest.raises(pa.ArrowInvalid):
        floats_from(pa.chunked_array([["a"]]))


def test_pandas_is_not_loaded_for_it():
    call = (
        "import sys, numpy as np, pyarrow as pa\n"
        "from tsas_cli.recordings.parquet_files import *\n"
        "column = column_of(np.array([1.0, np.nan]))\n"
        "floats_from(pa.chunked_array([column]))\n"
        "assert 'pandas' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", call], check=True)
