"""What the stages write about closed loops, made by hand."""

import math
from pathlib import Path

import numpy as np
import pyarrow as pa

from tests.reporting.made_folders import write_stage
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.tracking.settings import Settings

BOUNDS = {"lowest": [0.001, 2.0, 0.01], "highest": [0.1, 200.0, 0.4]}
LATE = {"quantity": "friction_coefficient", "value": 0.16, "from_s": 6.0}


def make_tracking(folder: Path, controllers=("pid", "adaptive-sliding-mode"), **more) -> Path:
    """Write what `tsas track` would say about a force that is missed by 1 N, and by 2 N later."""
    time_s = np.arange(0.0, 4 * math.pi, 0.01)
    wanted = 43.0 - 18.0 * np.cos(time_s)
    x_inv = 12.0 - 12.0 * np.cos(time_s)
    table = {"time_s": time_s, "f_out_N": wanted, "f_out_ref_N": wanted, "x_inv_mm": x_inv}
    table["x_in_mm"] = x_inv - 0.25 * (1.0 - np.cos(time_s))
    table["motor_speed_rpm"] = 500.0 * np.sin(time_s)
    estimates = {
        "phi1_rpm_s3_per_mm": np.where(time_s < 2 * math.pi, 0.005, 0.1),
        "phi2_rpm_s_per_mm": 18.0 + time_s,
        "phi3_rpm_s2_per_mm": np.full(time_s.size, 0.02),
    }
    conditions = {"undisturbed": [], "disturbed": [LATE]}
    results, tables = [], {}
    for missed_N, condition in enumerate(conditions, start=1):
        for number, name in enumerate(controllers):
            run_id = f"{name}-{condition}"
            own = table | {"f_out_true_N": wanted - missed_N}
            if name == "adaptive-sliding-mode":
                own |= estimates
            tables[run_id] = pa.table(own)
            results.append(_result(name, condition, run_id, 0.2 + 0.6 * number))
    folder.mkdir(parents=True)
    runs = [Run(id=i, file=f"runs/{i}.parquet", sha256="0" * 64) for i in tables]
    manifest = Manifest(format=1, name="tracking", kind="simulated", run=tuple(runs))
    write_dataset(folder, manifest, tables)
    content = {
        "model": {"file": "data sheet"},
        "plant": {"file": "rig.toml", "sha256": "ab" * 32},
        "drive": {"file": "drive.toml", "sha256": "cd" * 32},
        "dynamics": "lugre",
        "settings": {
            "file": None,
            "sensor": {"rate_Hz": 100.0, "noise_mm": 0.005, "step_mm": 0.002},
            "loop": {"filter_Hz": 10.0},
            "controllers": {"adaptive-sliding-mode": BOUNDS},
        },
        "reference": {"shape": "sine"},
        "gains": "default",
        "seeds": [3, 7],
        "conditions": conditions,
        "results": results,
        "notes": ["pid-disturbed: the motor is at its <limit>"],
    }
    return write_stage(folder, TrackingFile, **content | more)


def _result(controller, condition, run_id, rmse):
    at_limit = {"mean": 12.5 if condition == "disturbed" else 0.0, "sd": 0.5}
    scores = _scores(rmse, 0.0031) | {"at_limit_percent": at_limit}
    result = {"controller": controller, "condition": condition, "run": run_id}
    return result | {"scores": scores, "unsettled_steps": 0}


def _scores(rmse, spread):
    scores = {"lowest_error_N": (-2.5, 0.02), "highest_error_N": (1.5, 0.02)}
    scores |= {"outside_percent": (0.0, 0.0), "at_limit_percent": (0.0, 0.5)}
    scores |= {"effort_rpm": (353.6, 0.1), "chatter_rpm_per_s": (1234.0, None)}
    scores["rmse_N"] = (rmse, spread)
    return {name: {"mean": mean, "sd": sd} for name, (mean, sd) in scores.items()}


CASES = {  # case: title, hidden, named, and by controller the RMSE from data sheet to true
    "backlash": (
        "backlash",
        {"backlash.play_mm": 0.15},
        [{"effect": "backlash", "rivals": []}],
        {"pid": (0.4, 0.3, 0.1, 0.08), "disturbance-observer": (0.6, 0.4, 0.2, 0.2)},
    ),
    "bend": (
        "a <bend>",
        {"total_bend_rad": 4.0, "friction_drift.rate_per_s": 0.01},
        [],
        {"pid": (0.2, 0.3, 0.25, 0.24), "disturbance-observer": (1.2, 0.5, 0.04, 0.05)},
    ),
    "free_tendon": (
        "tendon outside the sheath",
        {"free_tendon.proximal_length_mm": 150.0},
        [
            {"effect": "drive_compliance", "rivals": ["free_tendon"]},
            {"effect": "presliding", "rivals": []},
        ],
        {"pid": (0.105, 0.3, 0.1, 0.1), "disturbance-observer": (0.9, 0.4, 0.1, 0.1)},
    ),
}


def make_closing(folder: Path, cases=CASES, **more) -> Path:
    """Write what `tsas close-loop` would say, without the folders of the cases."""
    made = [
        {"case": name, "title": title, "hidden": hidden, "reason": "", "named": named}
        | {"verdict": "named" if named else "sufficient"}
        | {"controllers": [_closed(*row) for row in rows.items()]}
        for name, (title, hidden, named, rows) in cases.items()
    ]
    settings = Settings().model_dump(mode="json", by_alias=True)
    content = {"settings": settings, "seeds": [3, 7], "cases": made}
    return write_stage(folder, ClosingFile, **content | more)


def _closed(controller, rmse):
    models = ("data sheet", "calibrated", "extended", "true")
    return {
        "controller": controller,
        "models": {model: _scores(mean, 0.002) for model, mean in zip(models, rmse, strict=True)},
        "over_limit": rmse[2] / rmse[3],
    }
