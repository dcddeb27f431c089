"""Folders of stages whose JSON lies: paths, sizes, nesting, numbers."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa

from tests.hostile.case import Make, cases, columns
from tests.reporting.made_diagnoses import make_diagnosis
from tests.reporting.made_folders import make_calibration, make_check, make_dataset, make_simulation
from tests.reporting.made_loops import make_tracking
from tsas_cli.recordings.writing import write_parquet

MAKERS: dict[str, Callable[[Path, Path], Path]] = {
    "check": make_check,
    "calibration": make_calibration,
    "simulation": make_simulation,
    "diagnosis": lambda dataset, folder: make_diagnosis(dataset, folder, "named"),
}
Change = Callable[[Any], Any]


def stage(kind: str, change: Change, command: str = "report") -> Make:
    """Return a maker of a stage's folder whose JSON is changed: content, or text instead."""

    def make(folder: Path) -> list[object]:
        data = make_dataset(folder / "data", ("a",), samples=400)
        where = (
            make_tracking(folder / "s") if kind == "tracking" else MAKERS[kind](data, folder / "s")
        )
        path = where / f"{kind}.json"
        content = json.loads(path.read_text())
        changed = change(content)
        path.write_text(changed if isinstance(changed, str) else json.dumps(content))
        others = [where] if kind == "tracking" else [data, where]
        if command == "compare":
            return ["compare", where, where, "--out", folder / "o"]
        return ["report", *others, "--out", folder / "page.html"]

    return make


def put(*keys: object, value: object) -> Change:
    def change(content: Any) -> None:
        for key in keys[:-1]:
            content = content[key]
        content[keys[-1]] = value

    return change


def parameter(value: float) -> Make:
    return stage("calibration", put("parameters", 0, "value", value=value))


def deep(content: Any) -> str:
    return json.dumps(content)[:-1] + ', "x": ' + "[" * 100_000 + "]" * 100_000 + "}"


def rather_deep(content: Any) -> str:
    return json.dumps(content)[:-1] + ', "x": ' + '{"a":' * 400 + "1" + "}" * 400 + "}"


def very_long(content: Any) -> str:
    return json.dumps(content)[:-1] + ', "x": ' + "1" * 100_000 + "}"


FINDING = {"code": "x", "severity": "error", "sentence": "y", "first_s": 10**4000}


def outside(content: Any) -> None:
    for result in content["results"]:
        result["run"] = "../../secret"


def tracked_outside(command: str) -> Make:
    made = stage("tracking", outside, command)

    def make(folder: Path) -> list[object]:
        call = made(folder)
        names = ("time_s", "f_out_ref_N", "f_out_true_N")
        table = pa.table({name: columns()["time_s"] for name in names})
        write_parquet(folder / "secret.parquet", table)
        return call

    return make


CASES = cases(
    {
        "is nested too deep": {
            "nested 100,000 deep": stage("check", deep),
            "nested 400 deep": stage("check", rather_deep),
            "nested 400 deep, compared": stage("calibration", rather_deep, "compare"),
        },
        "an integer has thousands of digits": {
            "an integer of 10^5 digits": stage("check", very_long),
        },
        "should be a number": {
            "a first second of 4000 digits": stage("check", put("findings", value=[FINDING])),
            "a parameter of 4000 digits": parameter(10**4000),
        },
        "has changed since this stage read it": {
            "hashes of files outside": stage(
                "check", put("dataset", "hashes", value={"../../x": "0" * 64})
            ),
        },
        "should be a finite number": {
            "a parameter of 1e400": parameter(float("inf")),
            "a parameter that is NaN": parameter(float("nan")),
            "an infinite gain": stage(
                "diagnosis", put("named", 0, "gain_percent", value=float("-inf"))
            ),
        },
        "visible and similarity need a value": {
            "a similarity with corners missing": stage(
                "diagnosis", put("signatures", "similarity", value=[[1.0], [], [1.0, 2.0, 3.0]])
            ),
        },
        "run id '../../secret' must be usable as a file name": {
            "tracked runs outside": tracked_outside("report"),
            "tracked runs outside, compared": tracked_outside("compare"),
        },
    }
)
