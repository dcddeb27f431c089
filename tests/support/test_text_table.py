import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
from collections import Counter
from itertools import chain

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tsas_cli.support.text_table import table_lines

PRINT = """
from tsas_cli.commands.common import show
header = ("name", "run", "A [95 %]", "B [95 %]", "B − A [95 %]", "differs", "unit")
long = "[0.12499, 0.12502]"
rows = [(f"name_{n}", "a", f"0.1{n} {long}", f"0.2{n} {long}", f"0.3{n} {long}", "no", f"u{n}")
        for n in range(12)]
title = "parameters of a model → a/folder/with/a/long/name/that/has/no/blank/in/it/model.toml"
show({}, [(title, header, rows)], quiet=False, as_json=False)
"""
HEADER = ("effect", "RMSE [N]", "what it is")
ROWS = [
    HEADER,
    ("free_tendon", "0.125", "tendon outside of the sheath, in series with it"),
    ("drive_compliance", "12.5", "the drive gives way"),
]


def printed_at(columns: int) -> list[str]:
    """Return what a process prints on a terminal of so many columns."""
    outside, inside = pty.openpty()
    fcntl.ioctl(inside, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    with subprocess.Popen([sys.executable, "-c", PRINT], stdout=inside, env=environment):
        os.close(inside)
        out = b""
        while True:
            try:
                part = os.read(outside, 65536)
            except OSError:  # the other end is closed
                part = b""
            if not part:
                break
            out += part
    os.close(outside)
    return out.decode().replace("\r\n", "\n").splitlines()


@pytest.mark.parametrize("columns", [40, 80, 120])
def test_no_line_is_longer_than_the_terminal_and_no_value_is_lost(columns: int) -> None:
    lines = printed_at(columns)
    assert max(map(len, lines)) <= columns
    words = " ".join(lines).split()
    for n in range(12):
        for value in (f"name_{n}", f"0.1{n}", f"0.2{n}", f"0.3{n}", f"u{n}"):
            assert value in words
    assert words.count("[0.12499,") == words.count("0.12502]") == 36
    assert words.count("no") == 12


@settings(deadline=None)
@given(
    st.integers(1, 6).flatmap(
        lambda n: st.lists(
            st.lists(st.text("ab-. ", max_size=30), min_size=n, max_size=n), min_size=2, max_size=5
        )
    ),
    st.integers(16, 90),
)
def test_every_table_fits_and_keeps_its_letters(rows: list[list[str]], width: int) -> None:
    lines = list(table_lines("t", rows, width))
    assert max(map(len, lines)) <= width
    printed, held = (Counter("".join(of)) for of in (lines, chain(*rows[1:])))
    assert all(printed[letter] >= held[letter] for letter in "ab.")


def test_a_table_that_fits_looks_as_in_a_file() -> None:
    assert printed_at(200)[1:] == piped()[1:]


def piped() -> list[str]:
    done = subprocess.run([sys.executable, "-c", PRINT], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def test_piped_output_stays_whole_and_plain() -> None:
    lines = piped()
    assert len(lines) == 1 + 2 + 12 + 1
    assert max(map(len, lines)) > 80
    assert "\x1b" not in "".join(lines)


def test_a_cell_is_folded_between_words() -> None:
    assert list(table_lines("t", ROWS, 50)) == [
        "t",
        "  effect            RMSE [N]  what it is",
        "  ----------------  --------  --------------------",
        "  free_tendon       0.125     tendon outside of",
        "                              the sheath, in",
        "                              series with it",
        "  drive_compliance  12.5      the drive gives way",
    ]


def test_columns_that_do_not_fit_follow_beside_what_tells_the_rows_apart() -> None:
    assert list(table_lines("t", ROWS, 30)) == [
        "t",
        "  effect            RMSE [N]",
        "  ----------------  --------",
        "  free_tendon       0.125",
        "  drive_compliance  12.5",
        "",
        "  effect            what it is",
        "  ----------------  ----------",
        "  free_tendon       tendon",
        "                    outside of",
        "                    the",
        "                    sheath, in",
        "                    series",
        "                    with it",
        "  drive_compliance  the drive",
        "                    gives way",
    ]


def test_where_nothing_fits_each_row_is_a_block() -> None:
    lines = list(table_lines("t", ROWS, 20))
    assert lines[:3] == ["t", "  effect    free_ten", "            don"]
    assert max(map(len, lines)) <= 20
    assert "".join(line[12:] for line in lines[1:3]) == "free_tendon"


def test_a_table_without_names_in_its_header_is_folded_too() -> None:
    rows = [[""] * 5, ["", "", "", "", "a" * 10], ["", "a", "", "", ""]]
    assert list(table_lines("t", rows, 16)) == ["t", "     aaaaaaaaaa", "", "     a"]


def test_a_cell_of_blanks_needs_no_room() -> None:
    rows = [["", "", "a" * 3], [" ", "b" * 7, ""]]
    lines = list(table_lines("t", rows, 16))
    assert lines[1:] == ["    " + " " * 9 + "aaa", "    -------  ---", "    bbbbbbb"]


def test_a_row_that_a_part_says_nothing_of_is_left_out_of_it() -> None:
    rows = [("name", "run", "A", ""), ("x", "a", "1" * 15, ""), ("x", "a", "", "2" * 15)]
    assert list(table_lines("t", rows, 30)) == [
        "t",
        "  name  run  A",
        "  ----  ---  ---------------",
        "  x     a    111111111111111",
        "",
        "  name  run",
        "  ----  ---  ---------------",
        "  x     a    222222222222222",
    ]
