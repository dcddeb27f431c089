import pytest

from tsas_cli.commands.common import names, progress, show
from tsas_cli.support.errors import InputError

TABLES = [
    ("two runs", ("run", "noise"), [("a", "0.1 N"), ("b\x1b[2J", "12.5 N")]),
    ("none", (), []),
]


def test_a_table_is_aligned_and_names_cannot_steer_the_terminal(capsys):
    show({}, TABLES, quiet=False, as_json=False)
    assert capsys.readouterr().out.splitlines() == [
        "two runs",
        "  run       noise",
        "  --------  ------",
        "  a         0.1 N",
        "  b\\x1b[2J  12.5 N",
        "",
        "none",
        "",
    ]


def test_no_bar_is_drawn_into_a_file(capsys):
    with progress("fit", quiet=False) as step:
        step.ahead(2)
        step()
    assert capsys.readouterr() == ("", "")


def test_a_name_with_a_comma_is_given_in_quotes():
    assert names(None) is None
    assert names("a, b ,c") == ["a", "b", "c"]
    assert names('"a,b",5",c d') == ["a,b", '5"', "c d"]
    assert names("") == names("\n") == [""]
    with pytest.raises(InputError, match="has an open quote"):
        names('"a,b')
    assert names("a\nb,") == ["a", "b", ""]
