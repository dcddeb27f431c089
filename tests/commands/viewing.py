"""Commands that keep a viewer open, in processes of their own."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.processes import SOON_S
from tsas_cli.reporting.viewer.open import SCREENS

ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/\?url=\S+")


@contextmanager
def started(*words: object, state: Path, **environment: str) -> Iterator[subprocess.Popen[str]]:
    """Start `tsas WORDS` without a screen and without usage statistics; end it with the block."""
    env = {k: v for k, v in os.environ.items() if k not in SCREENS}
    env |= {"CI": "true", "TSAS_STATE_DIR": str(state), "PYTHONUNBUFFERED": "1", **environment}
    call = [sys.executable, "-m", "tsas_cli", *map(str, words)]
    with subprocess.Popen(
        call, env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def address_in(stream) -> re.Match:
    """Return the address in the first line of a stream that holds one."""
    for line in stream:
        if found := ADDRESS.search(line):
            return found
    raise AssertionError("no address before the end")


def ended(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[int, str, str]:
    """Ask a command to end; return its exit code and what it still said."""
    process.send_signal(number)
    out, err = process.communicate(timeout=SOON_S)
    return process.returncode, out, err
