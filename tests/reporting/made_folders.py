"""A dataset and what the stages write about it, made by hand: a play operator with known phases."""

import json
import math
import os
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow as pa

import tsas_cli as tsas
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.writing import write_dataset, write_parquet
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.tracking.settings import Settings

A = 0.125 * math.pi
NOISE = 0.1


@contextmanager
def edited(path: Path):
    """Yield what a JSON file holds, and write what becomes of it."""
    content = json.loads(path.read_text(encoding="utf-8"))
    yield content
    path.write_text(json.dumps(content), encoding="utf-8")


def make_dataset(folder: Path, ids=("a", "b"), *, name="bench", samples=4000) -> Path:
    """Write a dataset of sines through a play operator; return its folder."""
    folder.mkdir(parents=True)
    told = {"sheath_length_mm": 785.0, "total_bend_rad": math.pi, "preload_N": 25.0}
    runs = [
        Run(id=run_id, file=f"runs/{number}.parquet", sha256="0" * 64, **told)
        for number, run_id in enumerate(ids)
    ]
    manifest = Manifest(format=1, name=name, kind="simulated", run=tuple(runs))
    tables = {run_id: pa.table(columns(samples, seed=n)) for n, run_id in enumerate(ids)}
    write_dataset(folder, manifest, tables)
    return folder


def columns(samples, *, seed=0):
    """Return one run: two periods, tensions with noise of 0.1 N."""
    noise = np.random.default_rng(seed).normal(scale=NOISE, size=(2, samples))
    time_s = np.linspace(0.0, 4 * math.pi, samples)
    x_in, f_in, f_out, _ = play(time_s)
    return {
        "time_s": time_s,
        "x_in_mm": x_in,
        "f_in_N": f_in + noise[0],
        "f_out_N": f_out + noise[1],
    }


def play(time_s):
    """Return x_in, f_in, f_out and the phase of each sample, without noise."""
    x = 10 * np.sin(time_s - math.pi / 2) + 10
    low, high = (25 + 1.579 * x) * math.exp(-A), (25 + 1.579 * x) * math.exp(A)
    f_in, phase = np.full(x.size, 25.0), ["dead_band_up"]
    for i in range(1, x.size):
        dx = x[i] - x[i - 1]
        f_in[i] = min(max(f_in[i - 1] + 175.0 * dx, low[i]), high[i])
        slips = f_in[i] in (low[i], high[i])
        up, down = ("contraction", "loosening") if slips else ("dead_band_up", "dead_band_down")
        phase.append(up if dx > 0 else down)
    return x, f_in, f_in * np.exp(-A * np.tanh((f_in - 25 - 1.579 * x) / 5)), phase


def segments(time_s):
    """Return the play operator's phases as a stage writes them."""
    phase = play(time_s)[3]
    edges = [0, *(i for i in range(1, len(phase)) if phase[i] != phase[i - 1]), len(phase)]
    return [
        {"start_s": time_s[i], "end_s": time_s[j - 1], "phase": phase[i]}
        for i, j in pairwise(edges)
    ]


def source(dataset: Path, stage: Path) -> dict:
    read = read_dataset(dataset)
    return {
        "name": read.manifest.name,
        "folder": os.path.relpath(dataset, stage),
        "hashes": read.hashes(),
    }


def parameter(name, value, half_width=None, unit="", **more):
    one = {"name": name, "run": None, "value": value, "unit": unit, "origin": "data sheet"}
    if half_width is not None:
        one |= {"interval_low": value - half_width, "interval_high": value + half_width}
        one |= {"stderr": half_width / 1.96, "origin": "fitted"}
    return one | more


def make_check(dataset: Path, folder: Path, findings=()) -> Path:
    usual = {"column": None, "remedy": "", "first_s": None}
    return _write(folder, CheckFile, dataset, findings=[usual | one for one in findings])


def make_calibration(dataset: Path, folder: Path, cannot_tell=()) -> Path:
    """Write what `tsas calibrate` would say about the made dataset."""
    theory = {"contraction": 2.338, "loosening": 1.066}
    stiffness = [
        {"occurrences": 2, "samples": 500, "note": "", "kr": None}
        | {"run": run.id, "phase": phase, "expected_N_per_mm": km * 1.01}
        | {"theory_N_per_mm": theory.get(phase, 175.1), "theory_elastic_N_per_mm": None}
        | {"km": parameter("km", km, 0.02 * km, "N/mm", run=run.id)}
        for run in read_dataset(dataset).manifest.run
        for phase, km in (
            ("contraction", 2.33812),
            ("dead_band_down", 133.6),
            ("loosening", 1.066),
            ("dead_band_up", 147.1),
        )
    ]
    content = {
        "segments": {r.run.id: segments(r.time_s) for r in read_dataset(dataset)},
        "stiffness": stiffness,
        "parameters": [
            parameter("friction_coefficient", 0.12512, 0.0021),
            parameter("load_stiffness_N_per_mm", 1.579, unit="N/mm"),
        ],
        "cannot_tell": list(cannot_tell),
        "fit": {"converged": True, "message": "", "evaluations": 9, "solver": "trf"},
        "channels": {},
    }
    return _write(folder, CalibrationFile, dataset, **content)


def make_simulation(dataset: Path, folder: Path) -> Path:
    """Write what `tsas simulate` would say: the play operator without noise."""
    runs = {}
    (folder / "runs").mkdir(parents=True)
    for recording in read_dataset(dataset):
        _, f_in, f_out, _ = play(recording.time_s)
        table = pa.table({"time_s": recording.time_s, "f_in_N": f_in, "f_out_N": f_out})
        write_parquet(folder / "runs" / f"{recording.run.id}.parquet", table)
        channel = {"rmse": 0.2, "noise": NOISE, "samples": f_in.size, "unit": "N"}
        runs[recording.run.id] = {
            "unconverged_samples": 0,
            "channels": {"f_in_N": channel, "f_out_N": channel},
        }
    model = {"file": "data sheet"}
    return _write(folder, SimulationFile, dataset, model=model, dynamics="static", runs=runs)


SIGNATURES = {  # how visible, and which look alike
    "backlash": 130.0,
    "drive_compliance": 210.0,
    "free_tendon": 210.0,
    "sheath_compression": 190.0,
    "presliding": 95.0,
    "load_friction": 320.0,
    "drive_friction": 410.0,
    "direction_dependent_friction": 280.0,
    "force_sensor_gain": 300.0,
    "load_inertia": 0.4,
}
LIKENESS = {
    ("drive_compliance", "free_tendon"): 1.0,
    ("drive_compliance", "sheath_compression"): 0.97,
    ("free_tendon", "sheath_compression"): 0.97,
    ("direction_dependent_friction", "force_sensor_gain"): 0.96,
    ("drive_friction", "load_friction"): 0.8,
    ("backlash", "drive_compliance"): 0.7,
    ("backlash", "free_tendon"): 0.7,
    ("backlash", "presliding"): 0.6,
}
REASONS = {
    "named": "A free length of tendon at the drive explains what the nominal model misses.",
    "ambiguous": "The drive gives way: a free tendon or its compliance, these runs cannot tell.",
    "sufficient": "The nominal model is as near as noise allows.",
    "partly": "A free length of tendon is there, and something else.",
    "unexplained": "Something is left that no effect explains.",
    "undecided": "two strokes are too few to hold any out.",
}
EVIDENCE = "each of 4 runs is predicted by a fit to the others; 55 blocks count."
LEFT = ["time_s (f_in_N swings at 3.1 Hz)", "speed_mm_per_s"]


def make_diagnosis(dataset: Path, folder: Path, verdict: str, **more) -> Path:
    """Write what `tsas diagnose` would say with one of the verdicts of `REASONS`."""
    named = verdict in {"named", "ambiguous", "partly"}
    left = verdict in {"unexplained", "partly"}
    content = {
        "verdict": verdict,
        "reason": REASONS[verdict],
        "named": [_cause(rivals=verdict == "ambiguous")] if named else [],
        "channels": {},
        "remainder": {"unexplained": False, "depends_on": []},
        "next_experiment": "Record the same motion with twice the sheath length.",
    }
    if verdict != "undecided":
        before = 9.1 if named else {"sufficient": 1.0, "unexplained": 6.2}[verdict]
        content |= {
            "channels": {
                "f_in_N": _held_out("N", 0.1, before, 1.1 if named else before, 1.05),
                "f_out_N": _held_out("N", 0.08, 1.3, 1.2, 1.02),
                "x_out_mm": _held_out("mm", 0.008, before / 3, 1.15 if named else before / 3, 1.1),
            },
            "remainder": {"unexplained": left, "depends_on": LEFT if left else []}
            | {"share_percent": 12.0 if named else 100.0, "mean_square": 38.4 if left else 1.02},
            "candidates": _candidates(gain=87.2 if named else 0.1),
            "signatures": _signatures(),
            "residual_map": {"before": _maps(before), "after": _maps(0.2 if named else before)},
            "evidence": {"held_out": "runs", "blocks": 55, "runs": 4, "sentence": EVIDENCE},
            "cannot_tell": ["The preload stays open: no run is at <rest>."],
            "solver": "closed form",
        }
    return _write(folder, DiagnosisFile, dataset, **content | more)


def write_predictions(dataset: Path, folder: Path, wrong) -> Path:
    """Write what the diagnosis's models say: the nominal is off by `wrong(run, channel, x_in)`."""
    (folder / "runs").mkdir()
    for recording in read_dataset(dataset):
        x_in, f_in, f_out, _ = play(recording.time_s)
        columns = {"time_s": recording.time_s, "x_in_mm": x_in}
        for name, true in (("f_in", f_in), ("f_out", f_out)):
            columns[f"{name}_N"] = true
            columns[f"{name}_nominal_N"] = true + wrong(recording.run.id, name, x_in)
        write_parquet(folder / "runs" / f"{recording.run.id}.parquet", pa.table(columns))
    return folder


def off_at_the_end(run, channel, x_in):
    """Return what a nominal model misses in f_in near the upper reversal, of run b."""
    return np.where((x_in > 19.0) & (run == "b") & (channel == "f_in"), 3.0, 0.0)


def make_prediction(dataset: Path, folder: Path) -> Path:
    """Write what two models, one of them with more friction, predict of the made dataset."""
    rough = Model((Estimate("friction_coefficient", 0.2, "1", "given"),))
    tsas.predict([Model(()), rough], dataset, out=folder, fit_own=False)
    return folder


def _cause(*, rivals):
    length = {"value": 152.04, "stderr": 3.1, "interval_low": 145.9, "interval_high": 158.1}
    distal = dict.fromkeys(length) | {"value": 0.0}
    return {
        "effect": "free_tendon",
        "title": "Tendon outside the sheath",
        "equation": "x_in − x_sheath = (T0 − F0)·l/EA",
        "rivals": ["drive_compliance"] if rivals else [],
        "parameters": {
            "proximal_length_mm": length | {"unit": "mm", "at_bound": False},
            "distal_length_mm": distal | {"unit": "mm", "at_bound": True},
        },
        "gain_percent": 48.2,
        "gain_interval_percent": [44.9, 51.0],
    }


def _held_out(unit, noise, before, after, best):
    """Return one channel's errors, given in units of its noise."""
    return {
        "unit": unit,
        "rmse_before": before * noise,
        "rmse_after": after * noise,
        "noise_floor": noise,
        "attainable": best * noise,
    }


def _candidates(*, gain):
    return [
        {"effects": effects, "parameters": {}, "converged": place != 5}
        | {"gain_percent": gain / 2**place, "test_statistic": 6.0 - place}
        | {"mean_square": 1.02 + place, "convincing": gain / 2**place > 0.5 and place < 4}
        for place, effects in enumerate(
            [["free_tendon", "backlash"], *([name] for name in (*SIGNATURES, "bend_drift"))]
        )
    ]


def _signatures():
    names = list(SIGNATURES)
    pairs = LIKENESS | {(b, a): size for (a, b), size in LIKENESS.items()}
    return {
        "effects": names,
        "visible": list(SIGNATURES.values()),
        "similarity": [[1.0 if a == b else pairs.get((a, b), 0.1) for b in names] for a in names],
    }


def _maps(size):
    """Return errors that go with the travel since the reversal in f_in, little in x_out."""
    travel = [(size * math.exp(-k / 3), 0.8 * k, 0.8 * (k + 1), "") for k in range(12)]
    tension = [(size * (k - 5.5) / 9, 10 + 4 * k, 14 + 4 * k, "") for k in range(12)]
    phase = [
        (size * part, k, k, label)
        for k, (part, label) in enumerate(
            [(0.2, "contraction"), (0.9, "dead_band_down"), (-0.1, "loosening")]
        )
    ]
    run = [(0.1 * size, k, k, f"run {k}") for k in range(4)]
    signals = {"travel_since_reversal_mm": travel, "f_in_N": tension, "phase": phase, "run": run}
    return {
        channel: {
            signal: [
                {"from": a, "to": b, "label": label, "mean": part * mean, "sd": 1.0, "samples": 90}
                for mean, a, b, label in bins
            ]
            for signal, bins in signals.items()
        }
        for channel, part in (("f_in_N", 1.0), ("f_out_N", 0.02), ("x_out_mm", -0.4))
    }


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
    return _write(folder, TrackingFile, **content | more)


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
    return _write(folder, ClosingFile, **content | more)


def _closed(controller, rmse):
    models = ("data sheet", "calibrated", "extended", "true")
    return {
        "controller": controller,
        "models": {model: _scores(mean, 0.002) for model, mean in zip(models, rmse, strict=True)},
        "over_limit": rmse[2] / rmse[3],
    }


def _write(folder: Path, kind, dataset: Path | None = None, **content) -> Path:
    """Write what a stage says under its file's name, with what every stage says."""
    about = {"format": 1, "stage": kind.model_fields["stage"].default, "version": "0.1.0"}
    if dataset is not None:
        about["dataset"] = source(dataset, folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / kind.FILE).write_text(json.dumps(about | content), encoding="utf-8")
    return folder
