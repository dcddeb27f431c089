"""What a proposed map says and asks, and what is left out of it."""

import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.recordings.guess.rig_files import CHANNELS, run, sources, write_csv
from tests.recordings.guess.test_guess import FEWER, REPOSITORY, write_lab
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.support.errors import InputError


def test_the_map_is_whole_or_says_what_it_asks(path, tmp_path, here):
    write_lab(path, "readme")
    code, _, messages = here("ingest", path, "--guess", "--out", tmp_path / "m.toml")
    assert (code, messages) == (0, "")
    with pytest.raises(InputError, match=r"1 question is open: columns.x_in_mm.pulley_radius_mm"):
        read_map(tmp_path / "m.toml")
    text = (tmp_path / "m.toml").read_text()
    (tmp_path / "m.toml").write_text(text.replace('"?"\n', "27.1\n"))
    code, _, messages = here("ingest", path, "--map", tmp_path / "m.toml", "--out", tmp_path / "d")
    assert (code, messages) == (0, "")


def test_the_page_shows_the_map_that_is_proposed(path):
    """What the command prints there, `tests/docs/test_examples.py` holds."""
    write_lab(path, "readme")
    text = map_text(propose([path]))
    begin, end = text.index("[columns.x_in_mm]"), text.index('pulley_radius_mm = "?"')
    assert text[begin:end] in (REPOSITORY / "docs" / "ingest.md").read_text(encoding="utf-8")


def test_every_key_of_a_map_has_a_comment_above_or_beside_it(path):
    write_lab(path, "readme")
    for block in map_text(propose([path])).split("\n\n"):
        lines = block.splitlines()
        for i, line in enumerate(lines):
            if " = " in line and not line.startswith("#"):
                assert "#" in line or any(above.startswith("#") for above in lines[:i])


def test_what_a_file_name_says_is_a_pattern_that_works(tmp_path):
    path = write_csv(tmp_path / "L785.4_bend180_F0=25.csv", [*run().items()])
    text = map_text(propose([path]))
    begin = text.index("# [run.from_file_name]")
    answered = text[:begin] + text[begin:].replace("# ", "")
    (tmp_path / "m.toml").write_text(answered)
    mapping = read_map(tmp_path / "m.toml")
    found = mapping.run.from_file_name.pattern.search(f"raw/{path.name}").groupdict()
    assert found == {"length": "785.4", "bend": "180", "preload": "25"}
    assert mapping.run.conditions["total_bend_rad"].unit == "deg"


def test_files_that_do_not_go_with_the_others_are_named(tmp_path):
    (tmp_path / "notes.txt").write_text("bent by hand\n")
    for name in ("a.csv", "b.csv"):
        write_csv(tmp_path / name, [*run().items()])
    proposal = propose([tmp_path / name for name in ("notes.txt", "a.csv", "b.csv")])
    assert proposal.looked_at.path.name == "a.csv"
    assert [path.name for path in proposal.different] == ["notes.txt"]
    assert proposal.read["files"][0] == "*.csv"


def test_a_wrong_call_is_one_line(refused_here):
    assert "leave one of them out" in refused_here("ingest", "a.csv", "--guess", "--map", "m")


def test_text_gaps_and_what_rests_are_left_out_with_the_reason(path):
    names = ("time [s]", "x_in [mm]", "f_in [N]", "Operator", "Nothing", "Idle [mm]")
    some = (run()[n][::4] for n in ("time_s", "x_in_mm", "f_in_N"))
    rows = [f"{t},{x},{f},Jo,,4" for t, x, f in zip(*some, strict=True)]
    path.write_text("\n".join([",".join(names), *rows]))
    proposal = propose([path])
    assert list(sources(path).values()) == list(names[:3])
    assert proposal.looked_at.left_out == {"Operator": "column Operator holds 'Jo'"}
    assert set(proposal.not_taken) == {"Nothing", "Idle [mm]"}
    text = map_text(proposal)
    assert "Operator cannot be used" in text
    assert '# extra = ["Nothing", "Idle [mm]"]' in text


@FEWER
@given(data=st.data())
def test_any_numbers_make_a_map_and_no_defect(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("f") / "a.csv"
    known = ["time", "t [s]", "x_in", "F [N]", "F [mm]", "x [V]", "sample", "é?", ""]
    name = st.sampled_from(known)
    names = data.draw(st.lists(name, min_size=1, max_size=6))
    cell = st.sampled_from(["", "0", "1", "-1", "1e300", "inf", "nan", "-0.0", "3.5"])
    rows = [[data.draw(cell) for _ in names] for _ in range(data.draw(st.integers(1, 80)))]
    path.write_text("\n".join(",".join(row) for row in [names, *rows]) + "\n")
    try:
        text = map_text(propose([path]))
    except InputError:
        return
    tomllib.loads(text)


def test_title_lines_padded_with_delimiters_are_skipped(path):
    write_csv(path, [*run().items()], delimiter=";")
    path.write_text("Bench 42;;;\n;;;\nrecorded by;M;;\n" + path.read_text())
    assert propose([path]).read["skip_lines"][0] == 3
    assert set(sources(path)) == set(CHANNELS)


def test_a_column_that_looks_like_a_missing_channel_is_asked_about(path):
    r = run()
    angle = np.degrees(r["x_in_mm"] / 27.1)
    columns = [("t_s", r["time_s"]), ("motor_deg", angle), ("handle_in", r["x_out_mm"] / 25.4)]
    write_csv(path, [*columns, ("loadcell_motor_lbf", r["f_in_N"] / 4.448)])
    proposal = propose([path])
    asked = proposal.questions
    assert '"handle_in", "motor_deg"? An angle needs' in asked["columns.x_in_mm.source"]
    assert '"handle_in"' in asked["columns.x_out_mm.source"]
    assert "No question is open" not in map_text(proposal)


def test_what_no_column_tells_is_asked(path):
    noise = np.random.default_rng(1).standard_normal(run()["time_s"].size)
    columns = run() | {"x_out_mm": 5.0 + noise}
    names = ["t [s]", "x_in [V]", "x_out [mm]", "f_in [N]", "f_out [N]"]
    write_csv(path, list(zip(names, columns.values(), strict=True)))
    asked = propose([path]).questions
    assert asked["columns.x_in_mm.factor"] == "how many mm (or what else) is one of V?"
    assert "it does not follow" in asked["columns.x_out_mm.sign"]


def test_thousands_are_asked_about_and_no_column_is_left_out(path):
    rows = zip(*run().values(), strict=True)
    lines = [f"{t};{x};{y};{1000 * f:,.2f};{g}" for t, x, y, f, g in rows]
    path.write_text("\n".join([";".join(CHANNELS), *lines]))
    proposal = propose([path])
    assert "are thousands separated in it?" in proposal.questions["read.decimal"]
    assert "f_in_N" in sources(path)
    assert not proposal.looked_at.left_out


def test_a_table_above_the_recording_is_skipped(path):
    write_csv(path, [*run().items()])
    path.write_text('Sample,A 1\nRate,10 mm/min\n"",Most [N]\n1,52.1\n\n' + path.read_text())
    assert propose([path]).read["skip_lines"][0] == 4
    assert set(sources(path)) == set(CHANNELS)


def test_where_a_displacement_may_be_of_the_load_the_motor_may_be_the_drive(path):
    r = run()
    columns = [("t_s", r["time_s"]), ("motor_deg", r["x_in_mm"]), ("slide_mm", r["x_out_mm"])]
    write_csv(path, [*columns, ("f_in_N", r["f_in_N"]), ("f_out_N", r["f_out_N"])])
    proposal = propose([path])
    question = proposal.questions["columns.x_in_mm.source"]
    assert 'columns.x_out_mm; then x_in_mm may be "motor_deg", with pulley_radius_mm' in question
    assert "No column looks like" not in map_text(proposal)


def test_the_name_is_that_of_the_folder_with_all_files(tmp_path):
    files = [tmp_path / "bench" / run_id / "a.csv" for run_id in "12"]
    for path in files:
        path.parent.mkdir(parents=True)
        write_csv(path, [*run().items()])
    assert (propose(files).name, propose(files[:1]).name) == ("bench", "1")
