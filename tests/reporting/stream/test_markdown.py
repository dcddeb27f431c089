import pytest

from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.stream.markdown import plain_text, section_text, table_text


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("<script>", r"\<script\>"),
        ("[x](javascript:y)", r"\[x\]\(javascript:y\)"),
        ("a|b", r"a\|b"),
        ("f_in_N *now*", r"f\_in\_N \*now\*"),
        ("two\nlines", r"two\\nlines"),
        ("plain 1.5 N", "plain 1.5 N"),
        ("run `tsas check <x>` first", "run `tsas check <x>` first"),
        ("one ` alone <b>", r"one \` alone \<b\>"),
        ("in a cell `a|b`", r"in a cell a\|b"),
    ],
)
def test_nothing_in_a_name_is_read_as_markdown(name, shown):
    assert plain_text(name) == shown


def test_a_table_keeps_its_columns_whatever_the_cells_hold():
    table = Table("of runs", ("run", "RMSE"), (("a|b", "1"), ("<c>", "2")), frozenset({1}))
    lines = table_text(table).splitlines()
    assert lines[0] == "**of runs**"
    assert lines[3] == "|---|--:|"
    assert [line.replace(r"\|", "").count("|") for line in lines[2:]] == [3, 3, 3, 3]


def test_a_section_stands_over_its_parts_in_order():
    part = Section("b", "Inner", ("two",), points=("first", "second"), closing=("end",))
    text = section_text(Section("a", "Outer", ("one",), equations=("x = y",), parts=(part,)))
    assert text.split("\n\n") == [
        "# Outer",
        "one",
        "> x = y",
        "## Inner",
        "two",
        "- first\n- second",
        "end",
    ]
