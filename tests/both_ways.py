"""A program run in a process of its own, with kernels compiled and without."""

import json
import os
import subprocess
import sys


def answers(program, *, plain):
    """Return the columns of a program that prints [numba was loaded, columns] as JSON."""
    environment = os.environ | {"TSAS_PLAIN_PYTHON": "1" if plain else "0"}
    call = [sys.executable, "-W", "error", "-c", program]
    done = subprocess.run(call, env=environment, capture_output=True, text=True, check=True)
    compiled, columns = json.loads(done.stdout)
    assert compiled != plain
    return columns
