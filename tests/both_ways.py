"""A program run here, with kernels compiled, and in a process of its own, where they are not."""

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout


def answers(program, *, plain):
    """Return the columns of a program that prints [numba was loaded, columns] as JSON."""
    if plain:
        environment = os.environ | {"TSAS_PLAIN_PYTHON": "1"}
        call = [sys.executable, "-W", "error", "-c", program]
        done = subprocess.run(call, env=environment, capture_output=True, text=True, check=True)
        printed = done.stdout
    else:
        with redirect_stdout(io.StringIO()) as stream:
            exec(program, {"__name__": "__main__"})  # noqa: S102 # a test's own
        printed = stream.getvalue()
    compiled, columns = json.loads(printed)
    assert compiled != plain
    return columns
