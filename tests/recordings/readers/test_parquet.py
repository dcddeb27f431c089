import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tsas_cli.errors import InputError
from tsas_cli.recordings.readers import read
from tsas_cli.recordings.readers.options import ReadOptions


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.parquet"
    schema = pa.schema(
        [
            pa.field("t", pa.int32()),
            pa.field("f", pa.float32(), metadata={"unit": "lbf"}),
            ("w", pa.string()),
        ]
    )
    pq.write_table(pa.table([[0, 1], [1.5, None], ["a", "b"]], schema=schema), path)
    return path


def test_numbers_of_any_width_nulls_and_units(path):
    table = read(path, ReadOptions(), ["f", "t"])
    assert table.columns["t"].tolist() == [0, 1]
    assert table.columns["f"][0] == 1.5
    assert table.columns["f"][1] != table.columns["f"][1]
    assert table.units == {"f": "lbf"}


def test_text_and_missing_columns_are_said(path):
    with pytest.raises(InputError, match="row 1: column w holds 'a'"):
        read(path, ReadOptions(), ["w"])
    with pytest.raises(InputError, match="column x is missing; there are: t, f, w"):
        read(path, ReadOptions(), ["x"])


@pytest.mark.parametrize("kept", [0, 3, 100, -1])
def test_a_file_that_is_cut_short_is_one_line(path, kept):
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(InputError) as error:
        read(path, ReadOptions(), ["t"])
    assert str(path) in error.value.line()
