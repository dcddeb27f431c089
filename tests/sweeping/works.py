"""What workers can be told to do in tests; each takes the task and returns its answer."""

import json
import os
import signal
import time
from pathlib import Path

from tsas_cli.sweeping.outcome import success


def texts(numbers, **more):
    """Return tasks as workers are told of them."""
    return [json.dumps({"number": number, **more}) for number in numbers]


def squared(task):
    return success({"square": task["number"] ** 2}, []) | {"where": os.getpid()}


def outcome_of(task):
    print("talk of a library")
    return squared(task)


def one_raises(task):
    if task["number"] == 2:
        raise ValueError("two")
    return squared(task)


def one_kills_once(task):
    """Kill the own process at the first attempt at task 2."""
    mark = Path(task["folder"]) / "killed"
    if task["number"] == 2 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return squared(task)


def one_always_kills(task):
    if task["number"] == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return squared(task)


def slow(task):
    """Say who does it, then take some time."""
    (Path(task["folder"]) / f"{task['number']}-{os.getpid()}").touch()
    time.sleep(task["seconds"])
    return squared(task)
