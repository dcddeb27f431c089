import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
from collections import Counter
from itertools import chain

from hypothesis import given
from hypothesis import strategies as st

from tests.terminal import read_from
from tsas_cli.support.text_table import table_text

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
    ("free_tendon", "0.125", "tendon outside of the sheath, in series with it"),
    ("drive_compliance", "12.5", "the drive gives way"),
]


def printed_at(columns):
    """Return what a process prints on a terminal of so many columns."""
    outside, inside = pty.openpty()
    fcntl.ioctl(inside, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    with subprocess.Popen([sys.executable, "-c", PRINT], stdout=inside, env=environment):
        os.close(inside)
        return read_from(outside).replace("\r\n", "\n").splitlines()


def test_a_table_is_folded_for_the_terminal_and_no_value_is_lost():
    title, *lines = printed_at(80)
    assert title.endswith("model.toml")
    assert max(map(len, lines)) <= 80
    words = " ".join(lines).split()
    for n in range(12):
        for value in (f"name_{n}", f"0.1{n}", f"0.2{n}", f"0.3{n}", f"u{n}"):
            assert value in words
    assert words.count("[0.12499,") == words.count("0.12502]") == 36
    assert words.count("no") == 12


@given(
    st.integers(1, 6).flatmap(
        lambda n: st.lists(
            st.lists(st.text("ab-. ", max_size=30), min_size=n, max_size=n), min_size=2, max_size=5
        )
    ),
    st.integers(1, 90),
)
def test_every_table_keeps_its_words_and_fits_where_they_do(rows, width):
    _, *lines = table_text("t", rows[0], rows[1:], width)
    needed = [
        max((len(word) for cell in column for word in cell.split()), default=0)
        for column in zip(*rows, strict=True)
    ]
    assert max(map(len, lines), default=0) <= max(width, sum(needed) + 2 * len(needed))
    words = Counter(word for line in lines for word in line.split())
    assert words >= Counter(word for cell in chain(*rows) for word in cell.split())


def test_piped_output_stays_whole_and_plain_as_where_there_is_room():
    call = [sys.executable, "-c", PRINT]
    lines = subprocess.run(call, capture_output=True, text=True, check=True).stdout.splitlines()
    assert printed_at(200)[1:] == lines[1:]
    assert len(lines) == 1 + 2 + 12 + 1
    assert max(map(len, lines)) > 80
    assert "\x1b" not in "".join(lines)


def test_a_cell_is_folded_between_words():
    assert list(table_text("t", HEADER, ROWS, 50)) == [
        "t",
        "  effect            RMSE [N]  what it is",
        "  ----------------  --------  --------------------",
        "  free_tendon       0.125     tendon outside of",
        "                              the sheath, in",
        "                              series with it",
        "  drive_compliance  12.5      the drive gives way",
    ]


def test_words_stay_whole_where_there_is_too_little_room():
    narrow = list(table_text("t", HEADER, ROWS, 20))
    assert narrow[1] == "  effect            RMSE   what it"
    assert narrow[2] == "                    [N]    is"
    assert narrow == list(table_text("t", HEADER, ROWS, 1))


def test_a_cell_of_blanks_needs_no_room_and_without_rows_there_is_the_title_alone():
    lines = list(table_text("t", ["a", "b"], [["   ", "x"]], 6))
    assert lines == ["t", "  a  b", "  -  -", "     x"]

    assert list(table_text("t", HEADER, [], 20)) == ["t"]
