"""A limit to how long something may take."""

import re
import signal
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from tsas_cli.recordings.ingest_map import at_most


def test_what_is_late_is_ended_and_what_is_not_goes_on():
    before = signal.getsignal(signal.SIGALRM)
    with pytest.raises(TimeoutError), at_most(0.05):
        re.search("(a|aa)+b", 99 * "a")
    with at_most(1.0):
        pass
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) == before


def test_beside_the_main_thread_there_is_no_limit():
    def work():
        with at_most(0.01):
            time.sleep(0.05)
            return True

    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(work).result()
