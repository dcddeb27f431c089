import os
import re
from io import StringIO
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tsas_cli.recordings.parquet_files import check_size, open_parquet
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

ROOT = Path(__file__).parents[2]


def refusal(call, *arguments):
    with pytest.raises(InputError) as caught:
        call(*arguments)
    return caught.value.line()


def nested(deep, content=1):
    for number in range(deep):
        content = [content] if number % 2 else {"a": content}
    return content


def test_nesting_is_taken_up_to_the_limit(tmp_path):
    limits.depth(nested(limits.DEPTH), tmp_path)
    assert "nested too deep" in refusal(limits.depth, nested(limits.DEPTH + 1), tmp_path)
    limits.depth("text", tmp_path)


def test_dotted_keys_are_taken_up_to_the_limit_in_any_spelling(tmp_path):
    for part in ("a", '"a.b"', "'a b'", "a-b_9"):
        for dot in (".", " . "):
            limits.toml(f"x = 1\n{dot.join([part] * 99)} = 1", tmp_path)
            deep = f"x = 1\n[{dot.join([part] * 102)}]"
            assert "nested too deep" in refusal(limits.toml, deep, tmp_path)
    limits.toml('description = "' + "a line without end " * 10_000 + '"', tmp_path)
    limits.toml("pi = [" + "3.14159, " * 10_000 + "]", tmp_path)


def test_a_file_is_read_up_to_its_limit_without_its_mark(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbfabc")
    assert limits.text_of(path, 6) == "abc"
    assert "is larger than 5 bytes" in refusal(limits.text_of, path, 5)
    with pytest.raises(FileNotFoundError):
        limits.text_of(tmp_path / "b.toml", 5)


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert "is a pipe or a device" in refusal(limits.text_of, tmp_path / "pipe", 5)
    assert "is a folder" in refusal(limits.regular, tmp_path)


def test_lines_are_taken_up_to_the_limit(tmp_path):
    good = "x" * (limits.LINE - 1) + "\n"
    assert list(limits.lines(StringIO(good + "a\n\nb"), tmp_path)) == [good, "a\n", "\n", "b"]
    lines = limits.lines(StringIO("a\n" + "x" + good), tmp_path)
    assert "row 2: is longer than" in refusal(list, lines)


def test_columns_are_counted_and_their_names_measured(tmp_path):
    limits.columns(["Kraft [N]", "力", "", "x" * limits.NAME] * 100, tmp_path)
    assert "holds 10001 columns" in refusal(limits.columns, ["a"] * 10_001, tmp_path)
    for bad in ("x" * (limits.NAME + 1), "\ud800"):
        assert "the name of column 2" in refusal(limits.columns, ["a", bad], tmp_path)


def test_what_is_loaded_whole_has_to_fit_into_the_memory(tmp_path, monkeypatch):
    assert 10_000_000 < limits.available() < 1 << 50
    monkeypatch.setattr(limits, "available", lambda: 1_000_000_000)
    limits.fits(tmp_path / "a.mat", 1_000_000_000)
    line = refusal(limits.fits, tmp_path / "a.mat", 2_000_000_000)
    assert "needs 2 GB of memory, and 1 GB are free; use a larger machine, or export it" in line


def test_where_memory_ends_the_file_may_be_damaged(tmp_path):
    line = limits.out_of_memory(tmp_path / "a.bag").line()
    assert "see whether the file is whole; else use a larger machine, or export it" in line


@pytest.mark.parametrize("packed", ["snappy", "zstd"])
def test_a_recording_of_an_even_clock_and_channels_at_rest_is_taken(tmp_path, packed, monkeypatch):
    monkeypatch.setattr(limits, "HARMLESS", 0)
    rows = 1_000_000
    table = {"time_s": np.arange(rows), "x_in_mm": np.zeros(rows), "f_in_N": np.full(rows, 25.0)}
    path = tmp_path / "a.parquet"
    how = {"compression": packed, "column_encoding": {"time_s": "DELTA_BINARY_PACKED"}}
    pq.write_table(pa.table(table), path, use_dictionary=["x_in_mm", "f_in_N"], **how)
    with open_parquet(path) as file:
        check_size(file, path, tuple(table), whole=True)
        monkeypatch.setattr(limits, "PARQUET_EXPANSION", 10)
        numbers = refusal(lambda: check_size(file, path, tuple(table), whole=False))
    assert "1000000 rows" in numbers


@pytest.mark.parametrize("name", ["own", "my.own"])
def test_a_column_of_lists_is_refused_whatever_its_name(tmp_path, name):
    pq.write_table(pa.table({name: [[1.0], [2.0, 3.0]]}), tmp_path / "a.parquet")
    with open_parquet(tmp_path / "a.parquet") as file:
        said = refusal(lambda: check_size(file, tmp_path / "a.parquet", [name], whole=False))
    assert f"column {name}.list.element holds lists" in said


def test_the_page_states_the_limits():
    text = (ROOT / "docs/untrusted.md").read_text(encoding="utf-8").replace(",", "")
    numbers = {int(n) for n in re.findall(r"\d+", text)}
    mib = {limits.TOML_BYTES, limits.LINE, limits.HEADER, limits.FOOTER, limits.HARMLESS}
    assert limits.JSON_BYTES == 1 << 30
    assert {n // limits.MIB for n in mib} <= numbers
    stated = (
        limits.TOML_KEYS, limits.JSON_EXPANDS, limits.DEPTH, limits.RUNS, limits.UNKNOWN_KEYS,
        limits.COLUMNS, limits.NAME, limits.EXPANSION, limits.PARQUET_EXPANSION, limits.ITEMS,
    )  # fmt: skip
    assert set(stated) <= numbers
