from tsas_cli.support.errors import InputError, nearest, printable


def test_a_message_says_where_what_expected_and_what_to_do_in_this_order():
    parts = {"where": "a.parquet, row 12", "expected": "a number in N", "remedy": "run it"}
    error = InputError("column f_in_N holds text", **parts)
    line = "a.parquet, row 12: column f_in_N holds text; expected a number in N; run it"
    assert str(error) == error.line() == line
    assert InputError("no runs").line() == "no runs"


def test_a_name_from_a_file_cannot_break_the_line_or_steer_the_terminal():
    line = InputError("bad\nname", where="a\x1b[2Jb\u202e.parquet\x9b").line()
    assert line.isprintable()
    assert line == "a\\x1b[2Jb\\u202e.parquet\\x9b: bad\\nname"


def test_a_value_without_end_is_cut_and_the_place_is_whole():
    line = InputError(f"there is no run {3000 * 'b'}; as said", where=3000 * "a").line()
    assert line == f"{3000 * 'a'}: there is no run {200 * 'b'}… as said"


def test_printable_keeps_what_a_person_writes():
    assert printable("Prüfstand 3, 5 °C, μ = 0.1\\x") == "Prüfstand 3, 5 °C, μ = 0.1\\x"


def test_the_nearest_known_word_is_named_else_all_of_them():
    assert nearest("preload_n", ["load", "preload_N"]) == "did you mean preload_N?"
    assert nearest("zzz", ["load", "preload_N"]) == "known are load, preload_N"
    assert nearest("zzz", []) == "none are known here"
