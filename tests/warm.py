"""The command line in forks of a process that has its libraries and its machine code loaded.

Started as a program it reads calls from standard input, one JSON line each, runs each in a fork
that ends as any process does, and answers with how it ended and what memory it took. A new process
would spend most of its time on imports.
"""

import atexit
import gc
import json
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
PASSING = {"PYTEST_CURRENT_TEST", "PYTHONWARNINGS"}  # what differs from test to test
PASSING |= {"KMP_DUPLICATE_LIB_OK", "KMP_INIT_AT_FORK"}  # what scikit-learn sets once it is loaded
STRICT = ("error", None, Warning, None, 0)  # the filter of PYTHONWARNINGS=error
MEMORY = 4 << 30  # of addresses, of which the libraries take more than one GiB
SECONDS = 20  # of processor time; on the clock thirty times as long


def environment() -> dict[str, str]:
    """Return the environment of this process, but for what differs from test to test."""
    return {name: value for name, value in os.environ.items() if name not in PASSING}


class Warm:
    """The process that forks, in the environment that there is when it is started.

    Every warning is an error in it, and in a call that is strict.
    """

    def __init__(self, *modules: str, **environ: str) -> None:
        self.environment = environment()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.warm", *modules],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=self.environment | environ | {"PYTHONWARNINGS": STRICT[0]},
        )

    def run(
        self, arguments: Sequence[object], cwd: Path, *, strict: bool = False, limited: bool = False
    ) -> tuple[subprocess.CompletedProcess[str], int]:
        """Run `tsas` in a folder; return how it ended, and by how much its memory grew [bytes]."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        words = [str(argument) for argument in arguments]
        with TemporaryDirectory() as folder:
            streams = [Path(folder) / "out", Path(folder) / "err"]
            call = {"arguments": words, "streams": list(map(str, streams)), "cwd": str(cwd)}
            call |= {"strict": strict, "limited": limited}
            self.process.stdin.write(json.dumps(call) + "\n")
            self.process.stdin.flush()
            code, taken = json.loads(self.process.stdout.readline())
            texts = [path.read_text("utf-8", "surrogateescape") for path in streams]
        return subprocess.CompletedProcess(["tsas", *words], code, *texts), taken

    def close(self) -> None:
        """End it."""
        self.process.communicate(timeout=300)


def _end(main: Callable[[], None]) -> None:
    """Run a call and end the process with its code, without taking all modules apart."""
    code: object = None
    try:
        main()
    except SystemExit as end:
        code = end.code
    threading._shutdown()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 0 if code is None else 1)


def _limit() -> None:
    """Let this process have little memory and time."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    signal.alarm(30 * SECONDS)


def serve() -> None:
    """Answer calls until standard input ends."""
    import resource

    import tsas_studies.commands  # noqa: F401
    from tsas_cli.__main__ import main
    from tsas_cli.stages import calibrate, check, diagnose, ingest, report, simulate  # noqa: F401

    with warnings.catch_warnings(action="ignore"):
        for module in sys.argv[1:]:
            import_module(module)
    calibrate.calibrate(ROOT / "datasets" / "paper-groups", runs=["a"])  # loads machine code
    gc.freeze()
    for line in sys.stdin:
        call = json.loads(line)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        child = os.fork()
        if child == 0:
            os.chdir(call["cwd"])
            if not call["strict"]:
                warnings.filters.remove(STRICT)
                sys.warnoptions.clear()
                del os.environ["PYTHONWARNINGS"]
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            for number, path in enumerate(call["streams"], start=1):
                os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), number)
            if call["limited"]:
                _limit()
            sys.argv = ["tsas", *call["arguments"]]
            _end(main)
        _, status, usage = os.wait4(child, 0)
        taken = 1024 * max(0, usage.ru_maxrss - before)
        print(json.dumps([os.waitstatus_to_exitcode(status), taken]), flush=True)


if __name__ == "__main__":
    serve()
