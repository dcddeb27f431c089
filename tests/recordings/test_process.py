"""A reader that dies, hangs or takes all memory costs its own process, and is one line."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.recordings.readers.matlab_files import save_5
from tsas_cli.recordings import guards as module
from tsas_cli.recordings.guards import in_another_process
from tsas_cli.recordings.readers import read
from tsas_cli.recordings.readers.table import ColumnTable, ReadOptions
from tsas_cli.support.errors import InputError

COLUMN = np.arange(100_000) / 7


def dies(path):
    ctypes.string_at(0)


def hangs(path):
    time.sleep(60)


def seconds_left(path):
    return signal.getitimer(signal.ITIMER_REAL)[0]


def takes(path, size):
    return len(bytearray(size))


def prints(path):
    print("a library talks", flush=True)
    return os.getpid()


def is_wrong(path):
    return {}["nothing"]


def gives(path):
    return ColumnTable({"x": COLUMN}, {"x": "mm"}, ("a",), 3)


def ask(path, function, *rest):
    return in_another_process(__name__, function.__name__, path, *rest, kind="a test")


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.mat"
    save_5(path, t=np.arange(5.0))
    return path


def test_what_is_read_comes_back_bit_by_bit(path):
    table = ask(path, gives)
    assert (table.units, table.header, table.first_row) == ({"x": "mm"}, ("a",), 3)
    assert table.columns["x"].tobytes() == COLUMN.tobytes()


def test_one_process_serves_many_files_and_is_not_this_one(path):
    first, second = ask(path, prints), ask(path, prints)
    assert first == second != os.getpid()


def test_a_crash_is_one_line_and_the_next_file_is_read(path):
    before = ask(path, prints)
    with pytest.raises(InputError, match=r"a\.mat: cannot be read as a test \(.*crashed\)"):
        ask(path, dies)
    assert ask(path, prints) != before
    assert read(path, ReadOptions(), ["t"]).columns["t"].tolist() == [0, 1, 2, 3, 4]


def test_after_a_file_that_was_refused_the_next_one_has_a_new_process(path):
    other = path.with_name("b.mat")
    other.write_bytes(path.read_bytes())
    before = ask(path, prints)
    with pytest.raises(InputError, match="x is missing"):
        read(path, ReadOptions(), ["x"])
    assert ask(path, prints) == before
    assert ask(other, prints) != before


def test_what_takes_too_long_is_ended(path, monkeypatch):
    monkeypatch.setattr(module, "LEAST_S", 0.5)
    with pytest.raises(InputError, match=r"not done after \d s"):
        ask(path, hangs)


def test_it_ends_by_itself_where_nobody_waits_any_more(path):
    assert module.LEAST_S < ask(path, seconds_left) < module.LEAST_S + 6


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")
def test_memory_is_limited_by_the_size_of_the_file(path, monkeypatch):
    monkeypatch.setattr(module, "LEAST_BYTES", 1 << 28)
    assert ask(path, takes, 1 << 20) == 1 << 20
    with pytest.raises(RuntimeError, match="MemoryError"):
        ask(path, takes, 1 << 30)
    path.write_bytes(bytes(1 << 27))
    assert ask(path, takes, 1 << 30) == 1 << 30


def test_a_defect_says_where_it_is(path):
    with pytest.raises(RuntimeError, match=r"is_wrong(.|\n)*KeyError"):
        ask(path, is_wrong)


def test_errors_name_the_file_as_it_was_called(path, monkeypatch):
    monkeypatch.chdir(path.parent)
    with pytest.raises(InputError, match=r"^a\.mat: column x is missing"):
        read(path.relative_to(path.parent), ReadOptions(), ["x"])


def test_the_process_ends_with_the_one_that_started_it(path):
    script = path.with_name("script.py")
    script.write_text(
        "from tests.recordings.test_process import ask, prints\n"
        "from pathlib import Path\n"
        f"print(ask(Path({str(path)!r}), prints))\n"
    )
    environment = os.environ | {"PYTHONPATH": str(Path(module.__file__).parents[2])}
    call = [sys.executable, str(script)]
    done = subprocess.run(call, env=environment, capture_output=True, text=True, check=True)
    for _ in range(400):
        try:
            os.kill(int(done.stdout), 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    pytest.fail("the process is still there")
