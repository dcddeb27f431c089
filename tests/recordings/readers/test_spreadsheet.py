"""Sheets of Excel, as they are typed."""

import numpy as np
import pytest

from tests.recordings.readers.workbooks import DATE, TIME, save_xlsx
from tests.refusals import refusal
from tsas_cli.recordings.guess.opening import open_file
from tsas_cli.recordings.readers import names, read, tables
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

LOG = [["Zeit [s]", "Kraft [N]"], [0.0, 1.5], [0.1, None], [0.2, "#N/A"], [0.3, -2e-7]]
NOTES = [["rig", "42"], ["weights", 3]]


@pytest.fixture
def write(tmp_path):
    return lambda **sheets: save_xlsx(tmp_path / "a.xlsx", sheets)


def test_numbers_gaps_and_faults_of_formulas(write):
    table = read(write(Log=LOG, Notes=NOTES), ReadOptions(), ["Zeit [s]", "Kraft [N]"])
    np.testing.assert_array_equal(table.columns["Kraft [N]"], [1.5, np.nan, np.nan, -2e-7])
    assert table.units == {"Zeit [s]": "s", "Kraft [N]": "N"}


@pytest.mark.parametrize("cell", ["25,3", "25,300", "broken"])
def test_a_text_among_numbers_is_what_is_wrong(write, cell):
    rows = [[0.01 * i, 20.0 + 0.125 * i] for i in range(5)]
    line = refusal(read, write(Log=[LOG[0], *rows, [0.05, cell]]), ReadOptions(), LOG[0])
    assert f"a.xlsx, row 7: column Kraft [N] holds '{cell}'" in line


def test_numbers_that_are_text_have_their_own_mark(write):
    rows = [LOG[0], ["0,1", "1,5"], ["0,2", "2,5"]]
    table = read(write(Log=rows), ReadOptions(table="Log"), LOG[0])
    assert table.columns["Kraft [N]"].tolist() == [1.5, 2.5]


def test_a_sheet_is_chosen_by_its_numbers_or_named(write):
    path = write(Notes=NOTES, Short=LOG[:3], Log=LOG)
    assert tables(path) == ["Log", "Short"]
    with pytest.raises(InputError, match=r"holds 2 sheets of numbers: Short, Log; .* table = "):
        names(path, ReadOptions())
    assert read(path, ReadOptions(table="Short"), [1]).columns[1].size == 2
    with pytest.raises(InputError, match="no sheet Lag; did you mean Log"):
        names(path, ReadOptions(table="Lag"))


def test_the_guess_asks_for_the_sheet(write):
    opened = open_file(write(Short=LOG[:3], Log=LOG))
    assert opened.read["table"][0] == "Log"
    assert opened.asked == {
        "table": "which table: Log, Short? The channels below are those of Log. If each is a run, "
        "list them (.join, docs/ingest.md)."
    }


def test_title_lines_and_units_below_the_names(write):
    rows = [["Bench 42", None, None], [None] * 3, ["t", "f", "w"], ["ms", "N", None], *[
        [i, 2.0 * i, "a"] for i in range(4)
    ]]  # fmt: skip
    opened = open_file(write(Log=rows))
    assert opened.read["skip_lines"][0] == 1
    assert opened.table.units == {"t": "ms", "f": "N"}
    assert list(opened.left_out) == ["w"]


@pytest.mark.parametrize("style", [DATE, TIME])
def test_dates_and_times_of_day_become_seconds(write, style):
    day = 45000.5 if style == DATE else 0.5
    rows = [["t", "f"], *[[(day + i / 86400, style), 1.0 * i] for i in range(3)]]
    table = read(write(Log=rows), ReadOptions(), ["t"])
    seconds = table.columns["t"] - table.columns["t"][0]
    np.testing.assert_allclose(seconds, [0, 1, 2], atol=1e-3)
    assert table.typed == {"t"}


def test_a_book_without_numbers_is_told(write):
    assert "no sheet holds numbers" in refusal(names, write(Words=[["a", "b"]]), ReadOptions())


def test_a_sheet_whose_numbers_are_text_is_found(write):
    assert tables(write(Notes=NOTES, Log=[LOG[0], ["0,1", "1.5e1"]])) == ["Log"]
