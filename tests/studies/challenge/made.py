"""Sealed answers and entries made by hand, and tools that answer in known ways."""

import json
import os
from pathlib import Path

from tsas_cli.support.errors import InputError

TRUTH = {"backlash": {"play_mm": 0.12}, "drive_friction": {"friction_N": 1.5}}
UNITS = {"play_mm": "mm", "friction_N": "N"}


def case(*effects, kind=None, size=1.0, unknown=None, **more):
    """Return one case of answers.json."""
    by_number = {0: "nothing", 1: "one", 2: "pair", 3: "triple"}
    return {
        "kind": kind or ("unknown" if unknown else by_number[len(effects)]),
        "size": size,
        "hidden": [{"effect": e, "parameters": TRUTH.get(e, {})} for e in effects],
        "unknown": unknown,
        **more,
        "nominal": {"friction_coefficient": 0.125},
        "noise": {"f_in_N": 0.1},
    }


def estimate(value, unit, stderr=None, **more):
    return {"value": value, "stderr": stderr, "unit": unit, "at_bound": False} | more


def named(effect, *rivals, **parameters):
    return {
        "effect": effect,
        "rivals": list(rivals),
        "parameters": parameters,
        "gain_percent": 48.2,
        "gain_interval_percent": [44.9, 51.0],
    }


def diagnosis(*names, verdict=None, unexplained=False, channels=None, **more):
    """Return the content of one diagnosis.json, as Contract 2 shows it."""
    return {
        "format": 1,
        "verdict": verdict or ("named" if names else "sufficient"),
        "named": [name if isinstance(name, dict) else named(name) for name in names],
        "channels": channels or {},
        "remainder": {"unexplained": unexplained, "depends_on": []},
        "next_experiment": "none",
    } | more


def described(name, *rivals):
    """Return the content of a law of unnamed origin."""
    return {
        "law": name,
        "title": "",
        "equation": "",
        "sentence": "",
        "parameters": {},
        "rivals": rivals,
        "channel": "f_in_N",
        "unit": "N",
        "rmse_before": 1.0,
        "rmse_after": 0.2,
    }


def write_set(folder: Path, cases) -> Path:
    """Write answers.json and an empty dataset folder for every case."""
    for name in cases:
        (folder / "cases" / name / "dataset").mkdir(parents=True)
    content = {"format": 1, "kind": "challenge-answers", "seed": 17, "cases": cases}
    (folder / "answers.json").write_text(json.dumps(content), encoding="utf-8")
    return folder


def write_entry(folder: Path, diagnoses) -> Path:
    folder.mkdir(exist_ok=True)
    for name, content in diagnoses.items():
        (folder / name).mkdir()
        (folder / name / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    return folder


def tool(dataset: Path, out: Path) -> None:
    """Answer by the name of the case, which says what is to happen."""
    name = dataset.parent.name
    if name == "refuses":
        raise InputError("no such run", where="a.parquet")
    if name == "silent":
        return
    if name == "threads":
        raise RuntimeError(f"{os.environ['OPENBLAS_NUM_THREADS']} threads")
    out.mkdir()
    (out / "diagnosis.json").write_text(json.dumps(diagnosis("backlash")), encoding="utf-8")
    if name == "dies":
        os._exit(9)
