"""Calls side by side: as one after the other, and really at once."""

import os
import signal
import threading
import time

import pytest

from tsas_cli.numerics.side_by_side import each
from tsas_cli.support.limits import THREADS


@pytest.mark.parametrize("threads", ["1", "2", "5"])
def test_the_answers_come_in_the_order_of_the_items(monkeypatch, threads):
    monkeypatch.setenv(THREADS, threads)
    assert each(lambda k: k * k, range(40)) == [k * k for k in range(40)]


def test_calls_run_at_once(monkeypatch):
    monkeypatch.setenv(THREADS, "2")
    both = threading.Barrier(2, timeout=120.0)
    assert each(lambda k: both.wait() >= 0 and k, [3, 4]) == [3, 4]


def test_what_a_call_raises_is_raised(monkeypatch):
    monkeypatch.setenv(THREADS, "2")
    with pytest.raises(ZeroDivisionError):
        each(lambda k: 1 / k, [1, 0])


def test_after_an_error_no_other_call_begins(monkeypatch):
    monkeypatch.setenv(THREADS, "2")
    begun, failed = [], threading.Event()

    def call(k):
        begun.append(k)
        if k == 0:
            failed.set()
            raise ZeroDivisionError
        assert failed.wait(20.0)
        time.sleep(0.5)

    with pytest.raises(ZeroDivisionError):
        each(call, range(50))
    assert len(begun) < 5


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
def test_a_fork_has_threads_of_its_own(monkeypatch):
    monkeypatch.setenv(THREADS, "2")
    assert each(abs, [1, -2]) == [1, 2]
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # where it waits for threads of its parent
        os._exit(0 if each(abs, [1, -2]) == [1, 2] else 1)
    assert os.waitpid(child, 0)[1] == 0
