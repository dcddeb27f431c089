import os
import signal
import subprocess
import sys
import time
from importlib import import_module
from types import SimpleNamespace

import pytest

from tsas_cli.support.stopping import CLEANUP_S, Stopped, until_stopped


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_request_to_end_is_the_end_of_the_block(number):
    events, before = [], [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]
    with until_stopped():
        try:
            os.kill(os.getpid(), number)
            time.sleep(5)
            events.append("still there")
        finally:
            os.kill(os.getpid(), number)  # an impatient person
            events.append("cleaned up")
    assert events == ["cleaned up"]
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)] == before


def test_other_errors_are_no_end():
    with pytest.raises(ZeroDivisionError), until_stopped():
        1 / 0  # noqa: B018


def ended(folder, program):
    """Return the exit code of a program that stops itself, run as a module."""
    (folder / "stopped.py").write_text(program)
    return subprocess.run([sys.executable, "-m", "stopped"], cwd=folder, check=False).returncode


def test_a_stop_while_text_is_executed_ends_with_the_exit_code_and_not_by_a_signal(tmp_path):
    """A library that makes a class from text is at it when the signal comes."""
    program = """
import signal, sys
from tsas_cli.support.stopping import EXIT_CODE, stopped_once
stopped_once()
try:
    exec("signal.raise_signal(signal.SIGTERM)")
except KeyboardInterrupt:
    sys.exit(EXIT_CODE)
"""
    assert ended(tmp_path, program) == 130


def test_a_stop_in_a_destructor_is_a_stop(tmp_path):
    """As in those of numba, which take a lock while it compiles."""
    program = """
import signal, sys, time
from tsas_cli.support.stopping import EXIT_CODE, stopped_once

class Compiled:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

stopped_once()
try:
    Compiled()
    time.sleep(5.0)
except KeyboardInterrupt:
    sys.exit(EXIT_CODE)
"""
    assert ended(tmp_path, program) == 130


def test_a_stop_while_a_compiled_library_is_loaded_comes_after_it(tmp_path):
    """What it imports in turn, here `copy`, is called from its own code, which may abort."""
    if not hasattr(import_module("_elementtree"), "__file__"):
        pytest.skip("this Python holds it itself")
    program = """
import signal, sys, time
from tsas_cli.support.stopping import EXIT_CODE, stopped_once
stopped_once()
sys.modules.pop("copy", None)
try:
    import _elementtree
    time.sleep(5.0)
except KeyboardInterrupt:
    sys.exit(EXIT_CODE if sys.modules["copy"].done and "_elementtree" in sys.modules else 1)
"""
    copy = "import signal; deepcopy = done = None; signal.raise_signal(signal.SIGINT); done = True"
    (tmp_path / "copy.py").write_text(copy)
    assert ended(tmp_path, program) == 130


@pytest.mark.parametrize("code", [0, 130])
@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_second_stop_while_the_program_ends_changes_no_exit_code(tmp_path, code, number):
    """At exit, and when Python takes its modules apart; a viewer that is closed ends with 0."""
    program = f"""
import atexit, os, signal, sys
from tsas_cli.support.stopping import stopped_once, until_stopped

def again(kill=os.kill, me=os.getpid(), number=signal.{number}):
    kill(me, number)

class Late:
    def __del__(self, again=again):
        again()

sys.late = Late()
stopped_once()
atexit.register(again)
try:
    if {code}:
        again()
    with until_stopped():
        again()
except KeyboardInterrupt:
    sys.exit({code})
"""
    assert ended(tmp_path, program) == code


def test_what_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as under nohup
    try:
        with until_stopped():
            os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_request_that_a_library_has_lost_can_be_made_again(monkeypatch):
    clock = SimpleNamespace(monotonic=lambda: now_s[0])
    monkeypatch.setattr("tsas_cli.support.stopping.time", clock)
    now_s, events = [100.0], []
    with until_stopped():
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except Stopped:
            events.append("lost")  # as a destructor does
        os.kill(os.getpid(), signal.SIGTERM)  # too soon
        events.append("goes on")
        now_s[0] += CLEANUP_S + 0.1
        os.kill(os.getpid(), signal.SIGTERM)
        events.append("goes on for ever")
    assert events == ["lost", "goes on"]
