"""The command line in forks of a process that has its libraries and its machine code loaded.

Started as a program it reads calls from standard input, one JSON line each, runs each in a fork
that ends as any process does, and answers with how it ended. A new process would spend most of
its time on imports.
"""

import atexit
import gc
import json
import os
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
PASSING = {"PYTEST_CURRENT_TEST", "PYTHONWARNINGS"}  # what differs from test to test
PASSING |= {"KMP_DUPLICATE_LIB_OK", "KMP_INIT_AT_FORK"}  # what scikit-learn sets once it is loaded
STRICT = ("error", None, Warning, None, 0)  # the filter of PYTHONWARNINGS=error


def environment() -> dict[str, str]:
    """Return the environment of this process, but for what differs from test to test."""
    return {name: value for name, value in os.environ.items() if name not in PASSING}


class Warm:
    """The process that forks, in the environment that there is when it is started.

    Every warning is an error in it, and in a call that is strict.
    """

    def __init__(self) -> None:
        self.environment = environment()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.warm"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=self.environment | {"PYTHONWARNINGS": STRICT[0]},
        )

    def run(
        self, arguments: Sequence[str], cwd: Path, *, strict: bool
    ) -> subprocess.CompletedProcess[str]:
        """Run `tsas` with these arguments in a folder."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        with TemporaryDirectory() as folder:
            out, err = Path(folder) / "out", Path(folder) / "err"
            call = {"arguments": arguments, "streams": [str(out), str(err)], "cwd": str(cwd)}
            call["strict"] = strict
            self.process.stdin.write(json.dumps(call) + "\n")
            self.process.stdin.flush()
            code = int(self.process.stdout.readline())
            texts = [path.read_text(encoding="utf-8") for path in (out, err)]
        return subprocess.CompletedProcess(["tsas", *arguments], code, *texts)

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


def serve() -> None:
    """Answer calls until standard input ends."""
    import tsas_studies.commands  # noqa: F401
    from tsas_cli.__main__ import main
    from tsas_cli.stages import calibrate, check, diagnose, ingest, report, simulate  # noqa: F401

    calibrate.calibrate(ROOT / "datasets" / "paper-groups", runs=["a"])  # loads machine code
    gc.freeze()
    for line in sys.stdin:
        call = json.loads(line)
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
            sys.argv = ["tsas", *call["arguments"]]
            _end(main)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


if __name__ == "__main__":
    serve()
