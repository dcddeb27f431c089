"""Outcome of a task, as plain data."""

import json
from typing import Any

Row = dict[str, Any]  # of a table whose columns the plan and its stage choose
TaskOutcome = Row


def failure(error: str, *, defect: bool = True) -> TaskOutcome:
    """Return the outcome of a failed task; the cause is a defect of the program, or its input."""
    return {"state": "failed", "error": error, "defect": defect}


def worker_death(times: int, message: str = "") -> TaskOutcome:
    """Return the outcome of a task whose worker died in each of `times` attempts."""
    often = "the process died" if times == 1 else f"the process died, {times} times"
    return failure(": ".join([often, *([message] if message else [])]))


def success(results: Row, parameters: list[Row]) -> TaskOutcome:
    """Return the outcome of a completed task: its key figures and estimated parameters."""
    return {"state": "done", "results": results, "parameters": parameters}


def run_task(work: str, text: str) -> str:
    """Return the outcome of a task, as JSON like the task; `work` is `module:function`."""
    from importlib import import_module

    module, _, name = work.partition(":")
    outcome: TaskOutcome = getattr(import_module(module), name)(json.loads(text))
    return json.dumps(outcome)
