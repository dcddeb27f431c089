"""What comes back of a task, as plain data."""

import json
from typing import Any

Row = dict[str, Any]  # of a table whose columns the plan and its stage choose
Answer = Row


def failure(error: str, *, defect: bool = True) -> Answer:
    """Return the answer of a task that has no result; a defect is ours, else its input is wrong."""
    return {"state": "failed", "error": error, "defect": defect}


def death(times: int, said: str = "") -> Answer:
    """Return the answer of a task whose worker died, as often as it was tried."""
    often = "the process died" if times == 1 else f"the process died, {times} times"
    return failure(": ".join([often, *([said] if said else [])]))


def success(results: Row, parameters: list[Row]) -> Answer:
    """Return the answer of a task that is done: its key figures, and the parameters it found."""
    return {"state": "done", "results": results, "parameters": parameters}


def called(work: str, text: str) -> str:
    """Return the answer of a function, named `module:function`, to a task, both as JSON."""
    from importlib import import_module

    module, _, name = work.partition(":")
    answer: Answer = getattr(import_module(module), name)(json.loads(text))
    return json.dumps(answer)
