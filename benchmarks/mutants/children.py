"""Processes that inherit the loaded libraries, so that each mutant starts in no time."""

import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path

HEAVY = (  # without what starts threads (pyarrow, so pandas): a fork does not take them along
    *("numba", "scipy.optimize", "scipy.signal", "scipy.stats", "scipy.interpolate"),
    *("scipy.linalg", "scipy.integrate", "pydantic", "typer", "tomlkit", "platformdirs"),
    *("pytest", "hypothesis", "control"),
)
ONE_THREAD = {"TSAS_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
TIMED_OUT = -1


def load() -> None:
    """Load what is slow to load and never mutated."""
    os.environ.update(ONE_THREAD)
    for name in HEAVY:
        import_module(name)
    if len([*Path("/proc/self/task").iterdir()]) > 1:
        raise RuntimeError("a library has started a thread: children would wait for it for ever")


def run(
    work: Callable[[], int],
    tree: Path,
    output: Path,
    environment: Mapping[str, str],
    *,
    processor_s: float,
) -> tuple[int, str]:
    """Run in a child of this process, in a folder; return its exit code and what it printed.

    `work` returns the exit code. It is ended after `processor_s` of processor time, `TIMED_OUT`
    then, and after ten times as long on the clock, so that one that waits for ever ends too.
    """
    child = os.fork()
    if not child:
        _become(tree, output, environment, processor_s)
        code = 3
        try:
            code = work()
        except BaseException:  # noqa: BLE001 # told to the parent by what is printed
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    end = time.monotonic() + 10 * processor_s
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        if time.monotonic() > end:
            os.killpg(child, signal.SIGKILL)
        time.sleep(0.02)
    code = os.waitstatus_to_exitcode(status)
    return (TIMED_OUT if code < 0 else code), output.read_text(errors="replace")


def _become(tree: Path, output: Path, environment: Mapping[str, str], processor_s: float) -> None:
    """Make this process that of one mutant."""
    os.setsid()
    descriptor = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(descriptor, stream)
    os.environ.update(environment)
    sys.dont_write_bytecode = True
    os.chdir(tree)
    sys.path[0] = str(tree)
    for name in list(sys.modules):  # what is loaded from here is not what is mutated
        if name.split(".")[0] in ("tsas_cli", "tests", "benchmarks"):
            del sys.modules[name]
    resource.setrlimit(resource.RLIMIT_CPU, (int(processor_s) + 1, int(processor_s) + 2))


def pytest_in(arguments: Sequence[str], plugins: Sequence[object] = ()) -> int:
    """Run pytest in this process; return its exit code."""
    import pytest

    loaded = ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
    quick = ["-q", "-n", "0", "-p", "no:cacheprovider", "--tb=short", *loaded]
    return int(pytest.main([*quick, *arguments], plugins=[*plugins]))
