"""Rows of one time become one, as the map says, across the parts of a file too."""

import numpy as np
import pytest

from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.recordings.ingest import ingest_files, merged
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.recordings.readers.table import ColumnTable, whole
from tsas_cli.recordings.run_files import read_columns
from tsas_cli.support.errors import InputError

TIME = np.array([0.0, 1, 1, 2, 2, 2, 3])
FORCE = np.array([5.0, 1, 3, 4, np.nan, 6, np.nan])
EXPECTED = {"first": [5, 1, 4, np.nan], "last": [5, 3, 6, np.nan], "mean": [5, 2, 5, np.nan]}


def parts(size):
    for first in range(0, TIME.size, size):
        rows = slice(first, first + size)
        yield ColumnTable({"t": TIME[rows], "f": FORCE[rows]}, {"t": "s"}, (), first + 10)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("how", list(EXPECTED))
def test_one_row_stays_of_each_time(how, size):
    found = list(merged(parts(size), "t", how))
    table = whole(found)
    np.testing.assert_array_equal(table.columns["t"], [0, 1, 2, 3])
    np.testing.assert_array_equal(table.columns["f"], EXPECTED[how])
    numbers = np.concatenate([part.row_numbers for part in found])
    assert numbers.tolist() == ([10, 12, 15, 16] if how == "last" else [10, 11, 13, 16])


def test_a_time_that_comes_again_later_is_another_row():
    times = np.array([0.0, 1, 0, np.nan, np.nan])
    table = whole(merged([ColumnTable({"t": times})], "t", "mean"))
    np.testing.assert_array_equal(table.columns["t"], times)


@pytest.fixture
def file(tmp_path):
    lines = [f"{k // 2 / 100:.2f},{k % 40},{k % 41}" for k in range(400)]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["time [s],x_in [mm],f_in [N]", *lines]))
    return path


@pytest.mark.parametrize(("how", "first_mm"), [("first", 0.0), ("last", 1.0), ("mean", 0.5)])
def test_the_guess_asks_and_ingest_does_what_is_answered(file, tmp_path, how, first_mm):
    text = map_text(propose([file]))
    assert "200 of 400 rows repeat the time before" in text
    path, folder = tmp_path / "map.toml", tmp_path / "made"
    path.write_text(text)
    with pytest.raises(InputError, match=r"read\.repeated_times"):
        read_map(path)
    answered = text.replace('repeated_times = "?"', f'repeated_times = "{how}"')
    path.write_text(answered.replace('sign = "?"', "sign = 1"))
    folder.mkdir()
    (run,) = ingest_files([file], read_map(path), path, folder)
    assert run.rows == 200
    assert read_columns(folder / "runs" / "a.parquet")["x_in_mm"][0] == first_mm
