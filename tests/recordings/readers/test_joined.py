"""One run from files with clocks of their own."""

from pathlib import Path

import numpy as np
import pytest

from tests.recordings.readers.workbooks import save_xlsx
from tsas_cli.recordings.ingest import find_files
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.joined import joined_by
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.recordings.readers.timebase import on_one_clock
from tsas_cli.support.errors import InputError

LIST = """
[drive]
file = "drive.csv"
time = "t [ms]"
[load]
file = "load.csv"
time = 1
unit = "s"
offset_s = -0.5
"""


ALL = ["time", "drive.x [mm]", "load.2"]


@pytest.fixture
def bench(tmp_path):
    drive = [f"{100 * i},{i},a" for i in range(11)]
    load = [f"{0.5 + 0.25 * i};{5 * i}" for i in range(5)]
    (tmp_path / "drive.csv").write_text("\n".join(["t [ms],x [mm],note", *drive]))
    (tmp_path / "load.csv").write_text("\n".join(load))

    def write(text=LIST):
        (tmp_path / "run.join").write_text(text)
        return tmp_path / "run.join"

    return write


def test_columns_are_named_by_their_part(bench):
    assert names(bench(), ReadOptions()) == ("drive.x [mm]", "load.2", "time")


def test_a_list_in_a_folder_stands_for_its_files(bench, tmp_path):
    path = bench()
    (tmp_path / "other.csv").write_text("t [ms],x [mm]\n0,1\n")
    assert joined_by(path) == [tmp_path / "drive.csv", tmp_path / "load.csv"]
    assert joined_by(tmp_path / "drive.csv") == []
    assert find_files([tmp_path], "*") == [tmp_path / "other.csv", path]


def test_a_unit_behind_the_name_of_a_clock_counts(bench, tmp_path):
    path = bench(LIST.replace("t [ms]", "time_ms"))
    drive = tmp_path / "drive.csv"
    drive.write_text(drive.read_text().replace("t [ms]", "time_ms"))
    table = read(path, ReadOptions(resample=True), ALL)
    np.testing.assert_allclose(table.columns["time"], np.arange(11) / 10)


def test_all_come_onto_the_clock_with_the_most_samples(bench):
    with pytest.raises(InputError, match="the channels have different times"):
        read(bench(), ReadOptions(), ALL)
    table = read(bench(), ReadOptions(resample=True), ALL)
    np.testing.assert_allclose(table.columns["time"], np.arange(11) / 10)
    np.testing.assert_allclose(table.columns["drive.x [mm]"], np.arange(11))
    np.testing.assert_allclose(table.columns["load.2"], 2 * np.arange(11))  # 20 a second
    assert table.units == {"time": "s", "drive.x [mm]": "mm"}


def test_an_offset_moves_one_clock(bench):
    table = read(bench(LIST.replace("-0.5", "-0.3")), ReadOptions(resample=True), ["time", 2, 1])
    np.testing.assert_allclose(table.columns["time"], np.arange(2, 11) / 10)
    np.testing.assert_allclose(table.columns[2], 20 * (np.arange(2, 11) / 10 - 0.2), atol=1e-12)


def test_rows_of_a_file_without_a_clock_count(bench):
    path = bench(LIST.replace('time = 1\nunit = "s"\noffset_s = -0.5', "rate_Hz = 4.0"))
    assert names(path, ReadOptions()) == ("drive.x [mm]", "load.1", "load.2", "time")
    table = read(path, ReadOptions(resample=True), ALL)
    np.testing.assert_allclose(table.columns["load.2"], 2 * np.arange(11))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"drive.csv"', '"../drive.csv"', "is another folder's file"),
        ('"drive.csv"', '"run.join"', "or a list"),
        ('"drive.csv"', '"other.csv"', "No such file"),
        ('"t [ms]"', '"t"', "column t is missing"),
        ('unit = "s"', "", "the clock 1 states no unit"),
        ('unit = "s"', 'unit = "mm"', "mm"),
        ('unit = "s"', "rate_Hz = 4.0", "needs a time, or rate_Hz"),
        ("time = 1", "", "needs a time, or rate_Hz"),
        ("offset_s", "offset", "offset"),
        ("-0.5", "50.0", "never overlap"),
        ("-0.5", "0.3", "the channels overlap for 0.2 s only"),
        (LIST, "a = 1", "a"),
    ],
)
def test_what_is_wrong_with_a_list_is_one_line(bench, old, new, message):
    path = bench(LIST.replace(old, new))
    with pytest.raises(InputError, match=message):
        read(path, ReadOptions(resample=True), ["drive.x [mm]", "load.2"])


def test_a_clock_of_dates_needs_an_offset(bench, tmp_path):
    rows = [f"2026-03-03 10:00:0{i},{i}" for i in range(5)]
    (tmp_path / "load.csv").write_text("\n".join(rows))
    text = LIST.replace('unit = "s"\noffset_s = -0.5', "")
    with pytest.raises(InputError, match="counts from the first date of its own file"):
        names(bench(text), ReadOptions())
    assert len(names(bench(f"{text}\noffset_s = 0.0"), ReadOptions())) == 3


RUNS = {"fast": 1.0, "slow": 5.0}


def test_each_sheet_of_a_workbook_can_be_a_run(tmp_path):
    sheets = {name: [["t [s]", "x"], [0.0, at], [1.0, at + 1.0]] for name, at in RUNS.items()}
    save_xlsx(tmp_path / "book.xlsx", sheets)
    for name in sheets:
        text = f'[bench]\nfile = "book.xlsx"\ntime = "t [s]"\nread = {{ table = "{name}" }}\n'
        (tmp_path / f"{name}.join").write_text(text)
    found = find_files([tmp_path], "*")
    assert [path.stem for path in found] == ["fast", "slow"]
    for path in found:
        table = read(path, ReadOptions(), ["time", "bench.x"])
        assert table.columns["bench.x"].tolist() == [RUNS[path.stem], RUNS[path.stem] + 1.0]


FAST = np.arange(9) / 10


@pytest.mark.parametrize("which", ["fast", "slow"])
@pytest.mark.parametrize("wrong", [0.1, 0.2, np.nan, np.inf])
def test_nothing_is_interpolated_on_a_clock_that_does_not_increase(which, wrong):
    times = {"fast": FAST.copy(), "slow": FAST[::2].copy()}
    times[which][3] = times[which][2] if wrong == 0.2 else wrong
    series = {source: (clock, clock) for source, clock in times.items()}
    with pytest.raises(InputError, match=rf"a.mf4, row 4: the time of {which} does not increase"):
        on_one_clock(series, Path("a.mf4"), clock_sources=["time"], resample=True)
