"""What the recorder writes, read back."""

import os
import subprocess
import sys
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
import rerun as rr
from rerun.blueprint import Blueprint, Tabs, Vertical
from rerun.chunk import RrdReader

from tests.refusals import refusal
from tests.reporting.stream.streams import make_stream, read
from tsas_cli.reporting.stream.layout import series
from tsas_cli.reporting.stream.recorder import is_finished, times_of, to_file
from tsas_cli.support.errors import InputError

TIME_S = np.array([0.0, 0.001, 0.3, 1234.5678912347])
NS = [0, 1_000_000, 300_000_000, 1_234_567_891_235]
LINE = "/run/a/f_in_N"


def written(folder, times, values=(0.0, 1.0, 2.0, 3.0)):
    """Return a series of a run as it is read back."""
    with to_file(folder / "s.rrd", "x") as recorder:
        recorder.series(LINE, times, np.array(values), "f", 0x112233FF)
    return read(folder / "s.rrd")["/run/a/f_in_N"]


@pytest.mark.parametrize(
    "started",
    [
        None,
        datetime(2026, 3, 2, 9, 30),  # noqa: DTZ001 # as a manifest may say it
        datetime(2026, 3, 2, 9, 30, tzinfo=UTC),
        datetime(2026, 3, 2, 11, 30, tzinfo=timezone(timedelta(hours=2))),
    ],
)
def test_times_are_rounded_to_the_nanosecond_and_a_known_start_is_the_session(tmp_path, started):
    """The last is 0.7 ns behind a nanosecond, which is not cut."""
    line = written(tmp_path, times_of(TIME_S, started))
    assert line.at().tolist() == NS
    assert set(line.times) == ({"t", "session"} if started else {"t"})
    if started:
        start = int(datetime(2026, 3, 2, 9, 30, tzinfo=UTC).timestamp()) * 10**9
        assert line.at("session").tolist() == [start + ns for ns in NS]


@pytest.mark.parametrize("values", [np.arange(3.0), np.arange(5.0)])
def test_columns_of_different_lengths_are_refused_and_nothing_is_written(tmp_path, values):
    with pytest.raises(ValueError, match="values at 4 times"):
        written(tmp_path, times_of(TIME_S), values)
    assert list(tmp_path.iterdir()) == []


def test_rerun_is_strict_while_a_stream_is_open(tmp_path):
    with pytest.raises(ValueError, match="same length"), to_file(tmp_path / "s.rrd", "x") as made:
        made.columns(LINE, times_of(TIME_S), rr.TextLog.columns(text=["one"]))


def test_names_from_files_are_one_part_of_a_path_each(tmp_path):
    odd = ["<script>", "a/b", "a b ", "__x", "é+*", "tab\there", "+ /**"]
    with to_file(tmp_path / "s.rrd", "x") as recorder:
        for name in odd:
            path = rr.new_entity_path(["run", name, "f"])
            recorder.series(path, times_of(TIME_S), np.arange(4.0), "f", 0x112233FF)
    found = [path for path in read(tmp_path / "s.rrd") if path.startswith("/run/")]
    assert len(found) == len(odd)
    assert all(path.replace("\\/", "").count("/") == 3 for path in found)
    assert "/run/\\<script\\>/f" in found


def test_a_series_is_drawn_by_its_extremes_and_a_gap_stays_a_gap(tmp_path):
    """The usual average would draw a fast chirp as if it decayed."""
    line = written(tmp_path, times_of(TIME_S), [1.0, np.nan, np.nan, 4.0])
    assert line.static["SeriesLines:aggregation_policy"] == [5]  # MinMax
    assert line.rows["Scalars:scalars"] == [[1.0], [], [], [4.0]]


def test_every_layout_is_an_application_of_its_own(tmp_path):
    """A viewer keeps the first layout that an application has shown."""

    def layout_with(name):
        return Blueprint(Tabs(Vertical(series(name, [LINE]), name="A"), series("s", [LINE])))

    ids = []
    for number, layout in enumerate(map(layout_with, ("one", "one", "two", "three"))):
        path = tmp_path / f"{number}.rrd"
        with to_file(path, "Prüfstand <1>", layout) as recorder:
            recorder.static("a", rr.TextDocument("hi"))
        reader = RrdReader(path)
        (recording,), (blueprint,) = reader.recordings(), reader.blueprints()
        assert blueprint.application_id == recording.application_id
        ids.append(recording.application_id)
    assert ids[0] == ids[1]
    assert len(set(ids)) == 3
    assert ids[0].startswith("tsas-Pr-fstand-1-")


def test_what_fails_leaves_no_file_and_replaces_none(tmp_path):
    path = tmp_path / "s.rrd"
    path.write_text("mine")
    with pytest.raises(InputError, match="already exists"), to_file(path, "x"):
        pass
    with pytest.raises(KeyError), to_file(tmp_path / "other.rrd", "x"):
        raise KeyError
    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]


def test_rerun_switched_off_is_said(tmp_path, monkeypatch):
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(InputError, match="switched off"), to_file(tmp_path / "s.rrd", "x"):
        pass


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return make_stream(tmp_path_factory.mktemp("streams") / "waves.rrd")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (lambda stream: b"", "file too small to be an RRD"),
        (lambda stream: stream[:11], "file too small to be an RRD"),
        (lambda stream: b"PAR1" + stream[4:], "Not an RRD file"),
        (lambda stream: stream[: len(stream) // 2], "exceeds file size"),
    ],
)
def test_what_is_no_whole_stream_is_refused(whole, tmp_path, content, told):
    assert is_finished(whole)
    path = tmp_path / "spoilt.rrd"
    path.write_bytes(content(whole.read_bytes()))
    line = refusal(is_finished, path)
    assert line.startswith(f"{path}: cannot be shown (")
    assert told in line


def test_a_stream_whose_writer_was_killed_can_be_shown(tmp_path):
    program = """
import os, sys, rerun
stream = rerun.RecordingStream("killed")
stream.save(sys.argv[1])
stream.log("note", rerun.TextDocument("all there is"))
stream.flush()
os._exit(0)
"""
    path = tmp_path / "killed.rrd"
    subprocess.run([sys.executable, "-c", program, path], check=True, env=os.environ)
    assert not is_finished(path)
