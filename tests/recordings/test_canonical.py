from pathlib import Path

import numpy as np
import pytest

from tests.refusals import refusal
from tsas_cli.recordings.canonical import canonical_columns
from tsas_cli.recordings.ingest_map import IngestMap
from tsas_cli.recordings.readers.table import ColumnTable
from tsas_cli.support.errors import InputError

TIME = {"source": "t", "unit": "ms"}
PLACE = {"source": "x", "unit": "in"}
FORCE = {"source": "f", "unit": "N"}


def ask(values=None, units=None, time=TIME, place=PLACE, force=FORCE, *, typed=(), **read):
    arrays = {"t": [0, 1, 2], "x": [1, 2, 3], "f": [4, np.nan, 6]} | (values or {})
    arrays = {k: np.array(v, dtype=float) for k, v in arrays.items()}
    table = ColumnTable(arrays, units or {}, (), 10, typed=frozenset(typed))
    columns = {"time_s": time, "x_in_mm": place, "f_in_N": force}
    content = {"dataset": {"name": "m"}, "read": read, "columns": columns}
    mapping = IngestMap.model_validate(content)
    return canonical_columns(table, mapping, Path("a.csv"), Path("map.toml"))[0]


@pytest.mark.parametrize(
    ("name", "said", "expected"),
    [
        ("time_s", {}, [0, 0.001, 0.002]),
        ("time_s", {"time": {"rate_Hz": 50}}, [0, 0.02, 0.04]),
        ("f_in_N", {}, [4, np.nan, 6]),
        ("x_in_mm", {}, [25.4, 50.8, 76.2]),
        # The sign comes before the offset, which is subtracted.
        ("x_in_mm", {"place": PLACE | {"sign": -1, "offset": 10.0}}, [-35.4, -60.8, -86.2]),
        (
            "x_in_mm",
            {"values": {"x": [np.nan, 2, 3]}, "place": PLACE | {"offset": "first"}},
            [np.nan, 0, 25.4],
        ),
    ],
)
def test_units_zeros_and_signs_are_those_of_the_map_and_gaps_stay_gaps(name, said, expected):
    np.testing.assert_allclose(ask(**said)[name], expected)


def test_the_files_own_unit_counts_where_the_map_says_none():
    assert ask(units={"f": "kN"}, force={"source": "f"})["f_in_N"][0] == 4000
    assert ask(units={"f": "kN"}, force=FORCE)["f_in_N"][0] == 4
    with pytest.raises(InputError, match=r"map.toml, columns.f_in_N: .* no unit for f; set it"):
        ask(force={"source": "f"})


def test_all_columns_without_a_unit_are_named_at_once():
    with pytest.raises(InputError, match=r"columns.x_in_mm, f_in_N: .* no unit for x, f; set it"):
        ask(place={"source": "x"}, force={"source": "f"})


def test_a_column_that_is_called_like_a_channel_has_its_unit():
    columns = ask(
        {"time_s": [0, 1, 2], "x_out_mm": [1, 2, 3]},
        time={"source": "time_s"},
        place={"source": "x_out_mm"},
    )
    assert (columns["time_s"].tolist(), columns["x_in_mm"].tolist()) == ([0, 1, 2], [1, 2, 3])
    with pytest.raises(InputError, match="the file states no unit for time"):
        ask({"time": [0, 1, 2]}, time={"source": "time"})


def test_a_map_cannot_say_another_unit_than_the_type_of_a_column():
    for time in ({"source": "t"}, TIME | {"unit": "s"}):
        assert ask(units={"t": "s"}, typed="t", time=time)["time_s"].tolist() == [0, 1, 2]
    with pytest.raises(InputError, match=r"time_s: the map sets unit ms for t, .*expected s, or"):
        ask(units={"t": "s"}, typed="t")


def test_extra_columns_travel_along_untouched():
    columns = ask({"a": [7, np.inf, 9], 2: [1, 2, 3]}, extra=["a", 2])
    np.testing.assert_array_equal(columns["a"], [7, np.inf, 9])
    np.testing.assert_array_equal(columns["column_2"], [1, 2, 3])


def test_rows_that_repeat_go_only_when_the_map_says_so():
    twice = {"t": [0, 1, 1, 2], "x": [1, 2, 2, 3], "f": [4, np.nan, np.nan, 6]}
    with pytest.raises(InputError, match=r"a.csv, row 12: .*repeated_times = .first."):
        ask(twice)
    np.testing.assert_allclose(ask(twice, drop_repeated_rows=True)["x_in_mm"], [25.4, 50.8, 76.2])
    held = {"t": [0, 1, 2, 3], "x": [1, 2, 2, 3], "f": [4, 5, 5, 5]}  # a sensor slower than its log
    np.testing.assert_allclose(ask(held, drop_repeated_rows=True)["time_s"] * 1e3, [0, 1, 3])
    with pytest.raises(InputError, match=r"a.csv, row 13: .*correct the file"):  # as in the file
        ask(twice | {"t": [0, 1, 1, 0.5]}, drop_repeated_rows=True)
    with pytest.raises(InputError, match="does not increase"):  # its other values differ
        ask({"t": [0, 1, 1]}, drop_repeated_rows=True)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"t": [0, 2, 1]}, "a.csv, row 12: the time does not increase (0.002 s, then 0.001 s)"),
        ({"t": [0, 1, 1]}, "a.csv, row 12: the time does not increase"),
        ({"t": [0, np.nan, 1]}, "a.csv, row 11: the time is empty"),
        ({"f": [1, 2, np.inf]}, "a.csv, row 12: f_in_N is infinite"),
        ({"f": [1, 2]}, "columns differ in length: t has 3, x has 3, f has 2"),
        ({"t": [0], "x": [0], "f": [0]}, "1 row; expected at least two"),
    ],
)
def test_what_cannot_be_a_recording_is_refused_with_its_row(values, message):
    assert message in refusal(ask, values)


@pytest.mark.parametrize("name", ["x_in_mm", "a\x1b[31m"])
def test_an_extra_column_may_not_take_a_name_that_is_taken_or_breaks_the_terminal(name):
    assert "cannot keep this name" in refusal(ask, {name: [1, 2, 3]}, extra=[name])


FACTOR = {"source": "x", "unit": "V", "factor": 1e15, "factor_unit": "m"}


@pytest.mark.parametrize(
    ("values", "place", "name"),
    [({"t": [0, 1, np.inf]}, PLACE, "time_s"), ({"x": [1, 2, 1e300]}, FACTOR, "x_in_mm")],
)
def test_what_grows_infinite_is_refused_without_another_word(values, place, name):
    with pytest.raises(InputError, match=f"{name} is infinite"):  # warnings are errors in tests
        ask(values, place=place)
