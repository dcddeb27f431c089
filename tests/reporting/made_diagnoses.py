"""What `tsas diagnose` writes, made by hand."""

import math
from pathlib import Path

import numpy as np
import pyarrow as pa

from tests.reporting.made_folders import play, write_stage
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.writing import write_parquet
from tsas_cli.records.diagnosis import DiagnosisFile

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
_SIZE = {"value": 1.0, "unit": "N", "interval_low": 0.9, "interval_high": 1.1}
LAW = {
    "law": "drive_law",
    "title": "Law at the drive",
    "equation": "f = g(x)",
    "sentence": "Elements at the drive.",
    "channel": "f_in_N",
    "unit": "N",
    "rmse_before": 0.62,
    "rmse_after": 0.11,
    "what": "f_in [N]",
    "travel_mm": [0.0, 1.0],
    "after_reversal": [0.0, 2.0],
    "place_mm": [0.0, 10.0],
    "along_stroke": [1.0, 1.1],
    "parameters": {"size_N": _SIZE, "x_out_size_mm": _SIZE},
}
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
    return write_stage(folder, DiagnosisFile, dataset, **content | more)


def write_predictions(dataset: Path, folder: Path, wrong, channels=("f_in", "f_out")) -> Path:
    """Write what the diagnosis's models say: the nominal is off by `wrong(run, channel, x_in)`."""
    (folder / "runs").mkdir()
    for recording in read_dataset(dataset):
        x_in, *forces, _ = play(recording.time_s)
        columns = {"time_s": recording.time_s, "x_in_mm": x_in}
        for name, true in zip(channels, forces, strict=False):
            columns[f"{name}_N"] = true
            columns[f"{name}_nominal_N"] = true + wrong(recording.run.id, name, x_in)
        write_parquet(folder / "runs" / f"{recording.run.id}.parquet", pa.table(columns))
    return folder


def off_at_the_end(run, channel, x_in):
    """Return what a nominal model misses in f_in near the upper reversal, of run b."""
    return np.where((x_in > 19.0) & (run == "b") & (channel == "f_in"), 3.0, 0.0)


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
