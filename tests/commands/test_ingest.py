import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

from tsas_cli.recordings.dataset import read_dataset

MAP = """
[dataset]
name = "bench"
[columns]
time_s = {source = "t", unit = "s"}
x_in_mm = {source = "x", unit = "in"}
f_in_N = {source = "f", unit = "N"}
"""
CSV = "t,x,f\n0,1,25\n0.5,2,\n1,3,27\n"
REPOSITORY = Path(__file__).parents[2]
MAPS = REPOSITORY / "datasets" / "maps"


@pytest.fixture
def bench(tmp_path):
    (tmp_path / "map.toml").write_text(MAP)
    (tmp_path / "a.csv").write_text(CSV)
    return tmp_path


OPTIONS = ("--map", "map.toml", "--out", "out")


@pytest.fixture
def ingest(bench, done):
    return lambda *words: done("ingest", *words, *OPTIONS, cwd=bench)


@pytest.fixture
def wrong(bench, refused):
    """Call the command, which refuses in one line that holds some words, and writes nothing."""

    def call(*words, says, options=OPTIONS):
        line = refused("ingest", *words, *options, cwd=bench)
        assert [word for word in says if word not in line] == []
        assert line.rstrip("\n").isprintable()
        assert not list(bench.glob("*out*"))

    return call


def test_a_unit_of_the_map_that_is_another_one_than_the_file_s_is_said_once(bench, ingest):
    (bench / "map.toml").write_text(
        MAP.replace('"t", unit = "s"', '"t [s]", unit = "ms"').replace('"x"', '"x [inch]"')
    )
    for name in "ab":
        (bench / f"{name}.csv").write_text(CSV.replace("t,x,f", "t [s],x [inch],f"))
    said = ingest("a.csv", "b.csv")
    assert said.count("- t [s] is in s by the file and in ms by the map, which counts.") == 1
    assert "x [inch]" not in said


def test_a_file_becomes_a_dataset_that_knows_what_it_was_made_from(bench, ingest):
    assert "a    3     1 s" in ingest("a.csv")
    (recording,) = read_dataset(bench / "out")
    np.testing.assert_allclose(recording.columns["x_in_mm"], [25.4, 50.8, 76.2])
    np.testing.assert_array_equal(recording.columns["f_in_N"], [25, np.nan, 27])
    source = read_dataset(bench / "out").manifest.ingest["sources"]["a"]
    assert source["sha256"] == hashlib.sha256(CSV.encode()).hexdigest()


def test_the_command_that_proposes_a_map_can_be_pasted(wrong):
    command = """`tsas ingest '$(touch ran) it'"'"'s.csv' --guess --out MAP.toml`"""
    says = ["--map is missing; ", f"; {command} proposes a map"]
    wrong("$(touch ran) it's.csv", says=says, options=())


def test_a_folder_is_searched_and_other_files_are_left_alone(bench, ingest):
    (bench / "runs" / "deep").mkdir(parents=True)
    (bench / "runs" / "b.CSV").write_text(CSV)
    (bench / "runs" / "deep" / "c.csv").write_text(CSV)
    (bench / "runs" / "photo.png").write_bytes(b"")
    (bench / "runs" / "._b.csv").write_bytes(b"left by a file manager")
    runs = json.loads(ingest("runs", "a.csv", "--json"))["runs"]
    assert [run["run"] for run in runs] == ["b", "c", "a"]
    assert runs[0]["rate_Hz"] == 2


def test_the_map_can_choose_among_a_folders_files(bench, ingest, wrong):
    (bench / "notes.txt").write_text("bent by hand")
    wrong(".", says=["notes.txt"])
    with (bench / "map.toml").open("a") as stream:
        stream.write('[read]\nfiles = "*.csv"\n')
    assert ingest(".", "-q") == ""
    assert len(read_dataset(bench / "out").manifest.run) == 1


def test_two_files_with_one_id_are_refused_and_both_named(bench, wrong):
    (bench / "other").mkdir()
    (bench / "other" / "a.csv").write_text(CSV)
    wrong("a.csv", "other", says=["'a'", "a.csv", "other/a.csv", "{folder}_{stem}"])


def test_half_of_the_files_are_not_half_a_dataset(bench, wrong):
    (bench / "b.csv").write_text("t,x\n0,1\n1,2\n")
    wrong("a.csv", "b.csv", says=["b.csv", "column f is missing; ", "there are: t, x"])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("b.csv", b"", "is empty"),
        ("b.mat", b"", "is empty"),
        ("b.parquet", b"PAR1", "cannot be read as Parquet"),
        ("b.docx", b"PK", "unknown file format .docx"),
        ("none.csv", None, "does not exist"),
        ("empty", "folder", "holds no file"),
    ],
)
def test_what_is_no_recording_is_one_line(bench, wrong, name, content, message):
    if content == "folder":
        (bench / name).mkdir()
    elif content is not None:
        (bench / name).write_bytes(content)
    wrong(name, says=[message])


@pytest.fixture
def public(done, tmp_path):
    """Return a function that ingests public recordings and gives them by run."""

    def ingested(name, *folders):
        home = Path(os.environ.get("TSAS_DATA", REPOSITORY / ".." / "shared" / "data")) / name
        if not home.is_dir():
            pytest.skip(f"no public recordings in {home}: set TSAS_DATA, see docs/ingest.md")
        sources = [home / folder for folder in folders] or [home]
        done("ingest", *sources, "--map", MAPS / f"{name}.toml", "--out", tmp_path / "d")
        return {recording.run.id: recording for recording in read_dataset(tmp_path / "d")}

    return ingested


def strokes(recording, half_window=50):
    """Return where x_in rises and where it falls, steadily."""
    x = recording.columns["x_in_mm"]
    speed = x[2 * half_window :] - x[: -2 * half_window]
    fast = 0.3 * np.abs(speed).max()
    inner = slice(half_window, -half_window)
    return inner, speed > fast, speed < -fast


def test_the_surgical_instrument_pulls_when_it_moves_in(public):
    recordings = public("mis-tool", "L_4", "pitch")
    assert len(recordings) == 9
    for recording in recordings.values():
        inner, pull, release = strokes(recording)
        tension = recording.columns["f_in_N"][inner]
        assert recording.run.load == "force"
        assert tension[pull].mean() > tension[release].mean()
        assert recording.columns["f_out_N"].mean() > 0
        x_in, x_out = recording.columns["x_in_mm"], recording.columns["x_out_mm"]
        assert np.corrcoef(x_in, x_out)[0, 1] > 0.99
        assert np.ptp(x_in) == pytest.approx(5 * np.pi / 3, rel=0.02)  # ±30° on 5 mm
    message = recordings["L_4_49"].run.model_extra
    assert (message["frequency_Hz"], message["load_percent"]) == (0.5, 100)
    assert recordings["pitch_pitch_5"].run.model_extra["wrist_pitch_deg"] == -60


def test_the_friction_damper_is_tight_at_the_drive_when_it_moves_in(public):
    recordings = public("friction-damper")
    assert len(recordings) == 4
    for recording in recordings.values():
        inner, pull, release = strokes(recording)
        drive, far = (recording.columns[name][inner] for name in ("f_in_N", "f_out_N"))
        assert drive[pull].mean() > 3 * far[pull].mean()
        assert far[release].mean() > 3 * drive[release].mean()
    assert recordings["1Hz80lbtension"].run.preload_N == pytest.approx(80 * 4.4482216)
