import base64

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from pyarrow.parquet import encryption

from tests.refusals import refusal
from tsas_cli.recordings.guess.opening import open_file
from tsas_cli.recordings.readers import batches, parquet, read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.recordings.run_files import read_columns
from tsas_cli.support.errors import InputError


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.parquet"
    pq.write_table(pa.table({"t": [0, 1], "f": [1.5, None], "w": ["a", "b"]}), path)
    return path


def test_text_and_missing_columns_are_said(path):
    assert "row 1: column w holds 'a'" in refusal(read, path, ReadOptions(), ["w"])
    assert "column x is missing; there are: t, f, w" in refusal(read, path, ReadOptions(), ["x"])


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("kind", [pa.timestamp, pa.duration])
def test_times_become_seconds_by_their_type_and_nulls_are_gaps(tmp_path, kind, unit):
    a_second = int(np.timedelta64(1, "s") / np.timedelta64(1, unit))
    start = 1_704_067_200 * a_second if kind is pa.timestamp else 0
    times = pa.array([start, None, start + 2 * a_second], kind(unit))
    field = pa.field("t", kind(unit), metadata={"unit": "min"})
    pq.write_table(pa.table([times], schema=pa.schema([field])), tmp_path / "a.parquet")
    table = read(tmp_path / "a.parquet", ReadOptions(), ["t"])
    np.testing.assert_array_equal(table.columns["t"], [0.0, np.nan, 2.0])
    assert (table.units, table.typed) == ({"t": "s"}, {"t"})


def test_dates_keep_their_zero_and_what_is_finer_than_a_microsecond(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet, "BATCH_ROWS", 2)
    start = 1_704_067_200 * 10**9
    times = pa.array([None, None, start, start + 100, start + 200, None], pa.timestamp("ns"))
    pq.write_table(pa.table({"t": times}), tmp_path / "a.parquet")
    parts = [part.columns["t"] for part in batches(tmp_path / "a.parquet", ReadOptions(), ["t"])]
    assert len(parts) == 3
    nan = np.nan
    np.testing.assert_array_equal(np.concatenate(parts), [nan, nan, 0.0, 1e-7, 2e-7, nan])


def test_one_of_two_columns_of_a_name_is_taken_by_its_number(tmp_path):
    path = tmp_path / "a.parquet"
    columns = [pa.array([float(i), i + 0.5]) for i in range(4)]
    pq.write_table(pa.Table.from_arrays(columns, ["t", "x", "x", "f"]), path)
    taken = read(path, ReadOptions(), [3, "f", 2]).columns
    assert {s: v.tolist() for s, v in taken.items()} == {3: [2, 2.5], "f": [3, 3.5], 2: [1, 1.5]}
    assert list(open_file(path).table.columns) == ["t", 2, 3, "f"]


def test_a_null_of_a_dictionary_is_a_gap(tmp_path):
    column = pa.array(["1", None, "3"]).dictionary_encode()
    pq.write_table(pa.table({"f": column}), tmp_path / "a.parquet")
    table = read(tmp_path / "a.parquet", ReadOptions(), ["f"])
    np.testing.assert_array_equal(table.columns["f"], [1.0, np.nan, 3.0])


class Keys(encryption.KmsClient):
    """A key service that wraps nothing."""

    def __init__(self, _):
        super().__init__()

    def wrap_key(self, key_bytes, _):
        return base64.b64encode(key_bytes)

    def unwrap_key(self, wrapped_key, _):
        return base64.b64decode(wrapped_key)


def encrypted(path, columns, *, plaintext_footer=True):
    settings = encryption.EncryptionConfiguration(
        footer_key="f", column_keys={"c": columns}, plaintext_footer=plaintext_footer
    )
    properties = encryption.CryptoFactory(Keys).file_encryption_properties(
        encryption.KmsConnectionConfig(), settings
    )
    time_s = np.arange(500) / 100.0
    table = pa.table({"time_s": time_s, "x_in_mm": np.sin(time_s), "f_in_N": np.cos(time_s)})
    with pq.ParquetWriter(path, table.schema, encryption_properties=properties) as writer:
        writer.write_table(table)
    return path


@pytest.mark.parametrize("column", ["time_s", "f_in_N"])
def test_an_encrypted_column_is_told_and_not_left_out(tmp_path, column):
    path = encrypted(tmp_path / "a.parquet", [column])
    with pytest.raises(InputError, match=f"column {column} is encrypted; .* without it"):
        open_file(path)
    with pytest.raises(InputError, match=r"a\.parquet: holds encrypted data; .* decrypt it"):
        read(path, ReadOptions(), [column])
    assert read(path, ReadOptions(), ["x_in_mm"]).columns["x_in_mm"].size == 500
    assert "holds encrypted data" in refusal(read_columns, path)


def test_an_encrypted_footer_is_told(tmp_path):
    path = encrypted(tmp_path / "a.parquet", ["f_in_N"], plaintext_footer=False)
    for opened in (open_file, read_columns, lambda at: read(at, ReadOptions(), ["x_in_mm"])):
        assert "holds encrypted data" in refusal(opened, path)
