import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.refusals import refusal
from tsas_cli.recordings.readers import read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError


@pytest.fixture
def ask(tmp_path):
    def call(text, *wanted, bytes_in="utf-8", **options):
        path = tmp_path / "a.csv"
        path.write_bytes(text.encode(bytes_in))
        table = read(path, ReadOptions(**options), wanted)
        return {k: v.tolist() for k, v in table.columns.items()}, table

    return call


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("   t     f\n 0.0   1.0\n 1.0  +2.5\n", ("t", "f")),
        ('"Force, N",t\n1,0\n2.5,1\n', ("t", "Force, N")),
        ("t, f\n0, 1\n\n1, 2.5\n\n\n", ("t", "f")),
        ("t,f,\n0,1,\n1,2.5,\n", ("t", "f")),
        ("t,f\n0,1,\n1,2.5,\n", ("t", "f")),
        ("t,note,f\n0,start,1\n1,end,2.5\n", ("t", "f")),
        ("% a rig\n% t, f\n0,1\n1,2.5\n", ("t", "f")),
        ("t,t\n0,1\n1,2.5\n", (1, 2)),
        ("t,f\n0,1\n# a pause\n1,2.5\n", ("t", "f")),
    ],
)
def test_odd_layouts_give_the_same_numbers(ask, text, names):
    """Usual ones are those of `any_table.py`."""
    columns, _ = ask(text, *names)
    assert columns == {names[0]: [0.0, 1.0], names[1]: [1.0, 2.5]}


def test_units_stand_in_a_row_of_their_own_or_in_brackets(ask):
    _, row = ask("t,f\n[ms],(lbf)\n0,1\n1,2\n", "t", "f")
    _, names = ask("t [ms],f (lbf)\n0,1\n1,2\n", "t [ms]", "f (lbf)")
    assert list(row.units.values()) == list(names.units.values()) == ["ms", "lbf"]


# The last: a thousand for as long as the head is looked at.
@pytest.mark.parametrize("cells", [["623", "1,237"], ["-1,237", "0"], ["1,237"] * 300 + ["623"]])
def test_commas_that_may_part_thousands_are_asked_about(ask, cells):
    text = "t\tf\n" + "".join(f"{i}\t{cell}\n" for i, cell in enumerate(cells))
    with pytest.raises(InputError, match=r"column 2 holds -?\d+ and -?1,237: .* decimal = \",\""):
        ask(text, "f")
    columns, _ = ask(text, "f", decimal=",")
    assert columns["f"] == [float(cell.replace(",", ".")) for cell in cells]


@pytest.mark.parametrize("cells", [["1,237", "2,474"], ["623", "1,237", "0,125"], ["62", "6,2"]])
def test_commas_that_are_decimal_marks_are_read_so(ask, cells):
    columns, _ = ask("t;f\n" + "".join(f"{i};{cell}\n" for i, cell in enumerate(cells)), "f")
    assert columns["f"] == [float(cell.replace(",", ".")) for cell in cells]


@pytest.mark.parametrize("delimiter", ["§", "│", "\u00a0"])
def test_any_character_can_be_the_delimiter(ask, delimiter):
    columns, _ = ask(f"t{delimiter}f\n0{delimiter}1\n1{delimiter}2.5\n", "f", delimiter=delimiter)
    assert columns["f"] == [1.0, 2.5]


@pytest.mark.parametrize("more", ["", "# the end\n"])  # read at once, and by lines
def test_tabs_alone_are_a_row_of_gaps_and_spaces_are_none(ask, more):
    columns, _ = ask(f"t\tf\n0\t1\n\t\n2\t3\n{more}", "t", "f")
    assert columns["f"] == pytest.approx([1.0, np.nan, 3.0], nan_ok=True)
    columns, _ = ask(f"t f\n0 1\n \n2 3\n{more}", "t", "f")
    assert columns["f"] == [1.0, 3.0]


def test_comment_lines_are_the_header(ask):
    _, table = ask("% made by hand\n% 0.50 Hz\nt,f\n0,1\n1,2\n", "t")
    assert table.header == ("made by hand", "0.50 Hz")


def test_encoding_and_lines_to_skip_are_taken_from_the_map(ask):
    text = "Logger\n17.3.2024\nt;µ °\n0;1,5\n1;2,5\n"
    columns, _ = ask(text, "µ °", bytes_in="cp1252", encoding="cp1252", skip_lines=2)
    assert columns["µ °"] == [1.5, 2.5]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,f\n0,1\n1,fast\n", ("row 3", "column f", "'fast'")),
        ("t,f\n10:00:00,1\nsoon,2\n", ("row 3", "column t holds 'soon'")),
        ("t,f\n" + "0,1\n" * 20_000 + "1,fast\n", ("row 20002", "column f", "'fast'")),
        ("t,f\n0,1\n1,2,3\n", ("row 3", "3 fields", "expected 2")),
        ("t,f\n0,1\n1\n", ("row 3", "1 field;", "expected 2", "delete what is no part")),
        ("t;f\n0.5;1.5\n0.75;2.5\n1.25;2,5\n", ("row 4", "column f", "'2,5'")),
        ("t,f,g\n0,1\n1,2\n", ("row 2", "3 column names and 2 fields")),
        ("t,g\n0,1\n1,2\n", ("column f is missing", "there are: t, g")),
        ("0,1\n1,2\n", ("2 columns without names",)),
        ("t;f\n0,5;1,5\n1,5;1.234,5\n", ("row 3", "'1.234,5'")),
        ("f,f\n0,1\n1,2\n", ("2 columns have the name f", "number")),
        ("t,f\n", ("no row",)),
        ("# nothing\n", ("holds no table",)),
        ("word" * 50_000, ("no row",)),
        ("", ("is empty",)),
        ("t,f\n0,1\n1,1_2\n", ("row 3", "'1_2'")),
        ("t,f\n0,1\n1,\x1b[31mred\n", ("row 3", "\\x1b[31mred")),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(ask, text, message):
    line = refusal(ask, text, "f", "t")
    assert [words for words in message if words not in line] == []


@pytest.mark.parametrize(
    ("encoding", "remedy"),
    [
        ("cp1252", 'set it in the map: encoding = "cp1252"'),
        ("utf-16", 'set it in the map: encoding = "utf-16"'),
        ("utf-32", 'set it in the map: encoding = "utf-32"'),
        ("utf-16-le", "is this a text table?"),
    ],
)
def test_the_wrong_encoding_is_reported_with_the_one_that_reads_the_file(ask, encoding, remedy):
    text = "t;µ\n0;1\n1;2\n"
    with pytest.raises(InputError, match=f"is not text in the encoding utf-8-sig; {remedy}"):
        ask(text, "t", bytes_in=encoding)
    assert ask(text, "t", bytes_in=encoding, encoding=encoding)[0] == {"t": [0, 1]}


@pytest.mark.parametrize(
    ("bytes_in", "encoding", "message"),
    [
        ("utf-16", "cp1252", r"in the encoding cp1252; .* encoding = .utf-16"),  # whatever is set
        ("utf-8", "klingon", "encoding of the map: the encoding 'klingon' is unknown"),
    ],
)
def test_an_encoding_that_reads_no_text_is_told(ask, bytes_in, encoding, message):
    with pytest.raises(InputError, match=message):
        ask("t;f\n0;1\n1;2\n", "t", bytes_in=bytes_in, encoding=encoding)


def test_text_of_an_encoding_that_is_not_recognised_is_to_be_saved_as_utf_8(ask):
    with pytest.raises(InputError, match="in the encoding cp1252; save it as UTF-8"):
        ask("t;最大\n0;1\n1;2\n", "t", bytes_in="shift_jis", encoding="cp1252")


def test_what_is_no_text_table_is_not_said_to_be_one(tmp_path):
    pq.write_table(pa.table({"t": [0.0, 1.0]}), tmp_path / "a.csv")
    for encoding in ("utf-8", "cp1252"):
        line = refusal(read, tmp_path / "a.csv", ReadOptions(encoding=encoding), ["t"])
        assert line.endswith("is this a text table? its name ends in .csv")


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        (["2026-03-03T10:00:00", "2026-03-03T10:00:00.25", "2026-03-03T10:00:01"], [0, 0.25, 1]),
        (
            ["2026-03-03 10:00:00,5", "2026-03-03 10:00:01", "2026-03-04 10:00:00,5"],
            [0, 0.5, 86400],
        ),
        (["2026-03-29T01:59:59+01:00", "2026-03-29T03:00:00+02:00", "NaN"], [0, 1, np.nan]),
        (["2026/03/03 10:00:00 UTC", "", "2026/03/03 10:00:02 UTC"], [0, np.nan, 2]),
        (["03.03.2026 23:59:59,5", "04.03.2026 00:00:00", "04.03.2026 00:00:01"], [0, 0.5, 1.5]),
        (["10:00:00", "10:00:00.125", "10:00:01"], [36000, 36000.125, 36001]),
        (["23:59:59.5", "00:00:00", "0:00:01"], [86399.5, 86400, 86401]),
    ],
)
def test_dates_and_times_of_day_become_seconds(ask, cells, seconds):
    rows = "\n".join(f"{cell};{i}" for i, cell in enumerate(cells))
    _, table = ask(f"when;f\n{rows}\n", "when", "f")
    np.testing.assert_allclose(table.columns["when"], seconds, rtol=0, atol=1e-9)
    assert (table.units, table.typed) == ({"when": "s"}, {"when"})


@pytest.mark.parametrize(
    ("cells", "decimal", "values"),
    [
        (["1,234.5", "-12,345,678"], ".", [1234.5, -12345678]),
        (["1.234,5", "7,25"], ",", [1234.5, 7.25]),
        (["1'234.5", "1 234"], ".", [1234.5, 1234]),
        (["1\u202f234,5", "0,5"], ",", [1234.5, 0.5]),
    ],
)
def test_thousands_are_read_once_the_decimal_mark_is_said(ask, cells, decimal, values):
    text = "t;f\n" + "".join(f"{i};{cell}\n" for i, cell in enumerate(cells))
    with pytest.raises(InputError, match=r"are thousands separated in it.*set decimal"):
        ask(text, "f")
    assert ask(text, "f", decimal=decimal)[0]["f"] == values


@pytest.mark.parametrize("cell", ["1,23", "0,125", "1,234,5", "12 345 6", "1,234 567"])
def test_other_groups_are_no_thousands(ask, cell):
    with pytest.raises(InputError, match="column f holds"):
        ask(f"t;f\n0;1.5\n1;{cell}\n", "f", decimal=".")
