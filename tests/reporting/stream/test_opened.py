import os
import subprocess
import sys

import pytest

from tests.refusals import refusal
from tests.reporting.viewer.streams import make_stream
from tsas_cli.reporting.stream.recorder import is_finished


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
