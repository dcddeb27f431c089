"""Columns between Arrow and NumPy, as pyarrow itself takes them over."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.recordings.rewritten import rewrite
from tests.test_app import loaded_by
from tsas_cli.recordings.parquet_files import column_of, floats_from
from tsas_cli.recordings.run_files import open_run
from tsas_cli.recordings.writing import columns_of
from tsas_cli.support.errors import InputError

NAN = float("nan")
DRIVE = {"time_s": [0.0, 1.0, 2.0], "x_in_mm": [0.0, 1.0, 2.0]}


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


def test_pandas_is_not_loaded_for_it():
    program = "import numpy as np, pyarrow as pa; from tsas_cli.recordings.parquet_files import *; "
    program += "floats_from(pa.chunked_array([column_of(np.array([1.0, np.nan]))]))"
    assert "pandas" not in loaded_by(program)


def rewritten(folder, table):
    return open_run(folder, rewrite(folder, pa.table(table)))


def test_null_is_a_gap_and_extra_columns_of_numbers_can_be_read(dataset):
    table = {"f_in_N": [1.0, None, 3.0], "own": [7.0, 8.0, 9.0]}
    run = rewritten(dataset, DRIVE | table | {"text": ["a", "b", "c"]})
    assert (run.names, run.rows) == (["time_s", "x_in_mm", "f_in_N", "own"], 3)
    np.testing.assert_array_equal(run.read("f_in_N"), [1.0, NAN, 3.0])
    assert run.read("own").tolist() == [7.0, 8.0, 9.0]
    with pytest.raises(InputError, match="text is missing; there are: time_s, x_in_mm, f_in_N, o"):
        run.read("text")


ONES = {"x_in_mm": [1.0], "f_in_N": [1.0]}


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (ONES, "time_s is missing"),
        (ONES | {"time_s": [0.0]}, "1 row"),
        (DRIVE | {"time_s": [0.0, 2.0, 1.0], "f_in_N": [1.0] * 3}, "row 2: time_s does not incr"),
    ],
)
def test_a_file_whose_time_is_none_is_refused(dataset, table, message):
    with pytest.raises(InputError, match=message):
        rewritten(dataset, table).read("time_s")


def test_a_column_that_a_stage_has_not_written_is_named(tmp_path):
    pq.write_table(pa.table({"f_in_N": [1.0]}), tmp_path / "a.parquet")
    with pytest.raises(InputError, match=r"a\.parquet: column f_out_N is missing$"):
        columns_of(tmp_path / "a.parquet", ["f_in_N", "f_out_N"])
