from tsas_cli.commands.common import progress, show

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
