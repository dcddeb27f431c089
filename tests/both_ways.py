"""A program run with kernels compiled and without: one way here, the other in a new process."""

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout

SWITCH = "TSAS_PLAIN_PYTHON"


def answers(program, *, plain):
    """Return the columns of a program that prints [numba was loaded, columns] as JSON."""
    if plain == (os.environ.get(SWITCH) == "1"):
        with redirect_stdout(io.StringIO()) as stream:
            exec(program, {})  # noqa: S102 # a test's own
        printed = stream.getvalue()
    else:
        call = [sys.executable, "-W", "error", "-c", program]
        environment = os.environ | {SWITCH: "1" if plain else "0"}
        done = subprocess.run(call, env=environment, capture_output=True, text=True, check=True)
        printed = done.stdout
    compiled, columns = json.loads(printed)
    assert compiled != plain
    return columns
