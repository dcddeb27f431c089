"""Which tests run a line, and how long each of them takes: one run of the tests under coverage."""

import json
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import pytest


class TooSlow(BaseException):
    """A test takes longer than judging thousands of mutants allows."""


class Reach:
    """A plugin of pytest: contexts of coverage by test, processor time and outcome of each."""

    def __init__(self, data: Path, sources: list[str], limit_s: float) -> None:
        import coverage

        self.times: dict[str, float] = {}
        self._slow: set[str] = set()
        self._limit_s = limit_s
        self._coverage = coverage.Coverage(data_file=str(data), include=sources)
        self._coverage.start()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Keep apart what each test runs, its fixtures too."""
        self._coverage.switch_context(item.nodeid)
        start = time.process_time()
        try:
            return (yield)
        finally:
            taken = time.process_time() - start
            if item.nodeid in self.times:
                self.times[item.nodeid] = taken
            self._coverage.switch_context("")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        """End a test at the limit: what it has run by then counts, its outcome does not."""
        family = item.nodeid.split("[")[0]
        if family in self._slow:
            pytest.skip("its sisters are too slow")
        running = True

        def stop(_: int, frame: FrameType | None) -> None:
            if running and frame and "tsas_cli" in frame.f_code.co_filename:
                raise TooSlow  # never within what holds a lock
            if running:
                signal.setitimer(signal.ITIMER_PROF, 0.05)

        signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, self._limit_s)
        try:
            result: Any = yield
        except TooSlow:
            self._slow.add(family)
            pytest.skip("too slow")
        finally:
            running = False
            signal.setitimer(signal.ITIMER_PROF, 0)
        self.times[item.nodeid] = 0.0
        return result

    def write(self, files: dict[str, Path], root: Path) -> None:
        """Write for each file of tests which of them run which lines, and how long each takes.

        Lines that run when a module is loaded belong to no test: "" stands for that.
        """
        self._coverage.stop()
        data = self._coverage.get_data()
        lines = {
            Path(measured).relative_to(root).as_posix(): data.contexts_by_lineno(measured)
            for measured in sorted(data.measured_files())
        }
        for tests, file in files.items():
            within = {
                path: {
                    str(line): [n for n in names if not n or n.startswith(tests + "::")]
                    for line, names in sorted(contexts.items())
                }
                for path, contexts in lines.items()
            }
            times = {n: t for n, t in self.times.items() if n.startswith(tests + "::")}
            file.write_text(json.dumps({"times_s": times, "lines": within}))
