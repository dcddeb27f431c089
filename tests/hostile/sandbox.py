"""A process that has everything imported and forks for each call, with little memory and time.

Started as a program it reads calls from standard input, one JSON line each, and answers with one.
"""

import gc
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MEMORY = 4 << 30  # of addresses, of which the libraries take more than one GiB
SECONDS = 20  # of processor time; on the clock thirty times as long


@dataclass(frozen=True)
class Ended:
    """How a call ended; `taken` is by how much its memory grew [bytes]."""

    code: int | None
    out: str
    err: str
    taken: int


class Sandbox:
    """The warm process."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.hostile.sandbox"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parents[2],
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "TSAS_THREADS": "1"},
        )

    def run(self, arguments: Sequence[object], cwd: Path) -> Ended:
        """Run `tsas` with these arguments in a folder."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        words = [os.fsdecode(os.fspath(a)) if isinstance(a, Path) else str(a) for a in arguments]
        self.process.stdin.write(json.dumps({"arguments": words, "cwd": str(cwd)}) + "\n")
        self.process.stdin.flush()
        return Ended(**json.loads(self.process.stdout.readline()))

    def close(self) -> None:
        """End it."""
        self.process.communicate(timeout=300)


def _in_child(call: dict[str, Any], out: int, err: int) -> None:
    from tsas_cli.__main__ import main

    os.chdir(call["cwd"])
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(out, 1)
    os.dup2(err, 2)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    sys.argv = ["tsas", *call["arguments"]]
    try:
        main()
    except SystemExit as end:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)


def _answer(call: dict[str, Any]) -> dict[str, Any]:
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        begun = time.monotonic()
        child = os.fork()
        if child == 0:
            try:
                _in_child(call, out.fileno(), err.fileno())
            finally:
                os._exit(99)
        ended, status, usage = os.wait4(child, os.WNOHANG)
        while ended == 0 and time.monotonic() - begun < 30 * SECONDS:
            time.sleep(0.005)
            ended, status, usage = os.wait4(child, os.WNOHANG)
        late = ended == 0
        if late:
            os.kill(child, signal.SIGKILL)
            ended, status, usage = os.wait4(child, 0)
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read(1 << 20).decode(errors="surrogateescape"))
    return {
        "code": None if late else os.waitstatus_to_exitcode(status),
        "out": texts[0],
        "err": texts[1],
        "taken": 1024 * max(0, usage.ru_maxrss - before),
    }


def serve() -> None:
    """Answer calls until standard input ends."""
    import asammdf  # noqa: F401
    import h5py  # noqa: F401
    import pint
    import pyarrow.csv
    import pyarrow.parquet  # noqa: F401
    import scipy.io  # noqa: F401

    import tsas_studies.commands  # noqa: F401
    from tsas_cli.stages import calibrate, check, compare, ingest, report  # noqa: F401

    pint.UnitRegistry()
    gc.freeze()
    for line in sys.stdin:
        print(json.dumps(_answer(json.loads(line))), flush=True)


if __name__ == "__main__":
    serve()
