import pytest

from tsas_cli.recordings.manifest import check_run_name, colliding_names


@pytest.mark.parametrize(
    "name",
    ["a", "bend180_0.5Hz", "2026-03-02T09:30:00", ".hidden", "--help", "a.", "力", "console"],
)
def test_names_that_name_a_file(name):
    check_run_name(name)


@pytest.mark.parametrize(
    "name",
    ["", ".", "..", "../x", "a/b", "a\\b", "a\0", "a\n", "\x1b[2J", "a\u202eb", " ", " a", "a ",
     "x" * 248, "力" * 83, "\ud800"],
)  # fmt: skip
def test_names_that_name_none(name):
    with pytest.raises(ValueError, match=r"file name|surrogates"):
        check_run_name(name)


@pytest.mark.parametrize("name", ["con", "CON", "Nul", "com1", "LPT9.csv", "aux.a.b"])
def test_devices_of_windows(name):
    with pytest.raises(ValueError, match="is a device on Windows"):
        check_run_name(name)


@pytest.mark.parametrize("name", ["a:b", "<b>", 'a"', "a|b", "a?", "a*"])
def test_marks_that_other_systems_do_not_allow(name):
    check_run_name(name)


def test_names_that_are_one_file_elsewhere():
    assert colliding_names(["a", "b", "c"]) is None
    assert colliding_names(["a", "b", "A"]) == ("a", "A")
    assert colliding_names(["\u00e9", "e\u0301"]) == ("\u00e9", "e\u0301")
    assert colliding_names(["stra\u00dfe", "STRASSE"]) == ("stra\u00dfe", "STRASSE")
