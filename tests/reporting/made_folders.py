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
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page

A = 0.125 * math.pi
NOISE = 0.1


def page_from(*folders: Path) -> str:
    """Return the page of what some folders hold."""
    return page(read_inputs(list(folders)))


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
    files = {run_id: f"runs/{number}.parquet" for number, run_id in enumerate(ids)}
    runs = [Run(id=i, file=file, sha256="0" * 64, **told) for i, file in files.items()]
    manifest = Manifest(format=1, name=name, kind="simulated", run=tuple(runs))
    tables = {run_id: pa.table(columns(samples, seed=n)) for n, run_id in enumerate(ids)}
    write_dataset(folder, manifest, tables)
    return folder


def columns(samples, *, seed=0):
    """Return one run: two periods, tensions with noise of 0.1 N."""
    noise = np.random.default_rng(seed).normal(scale=NOISE, size=(2, samples))
    time_s = np.linspace(0.0, 4 * math.pi, samples)
    x_in, f_in, f_out, _ = play(time_s)
    forces = {"f_in_N": f_in + noise[0], "f_out_N": f_out + noise[1]}
    return {"time_s": time_s, "x_in_mm": x_in, **forces}


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
    read, folder = read_dataset(dataset), os.path.relpath(dataset, stage)
    return {"name": read.manifest.name, "folder": folder, "hashes": read.hashes()}


def parameter(name, value, half_width=None, unit="", **more):
    one = {"name": name, "run": None, "value": value, "unit": unit, "origin": "data sheet"}
    if half_width is not None:
        one |= {"interval_low": value - half_width, "interval_high": value + half_width}
        one |= {"stderr": half_width / 1.96, "origin": "fitted"}
    return one | more


def make_check(dataset: Path, folder: Path, findings=()) -> Path:
    usual = {"column": None, "remedy": "", "first_s": None}
    return write_stage(folder, CheckFile, dataset, findings=[usual | one for one in findings])


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
    return write_stage(folder, CalibrationFile, dataset, **content)


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
    return write_stage(folder, SimulationFile, dataset, model=model, dynamics="static", runs=runs)


def make_prediction(dataset: Path, folder: Path) -> Path:
    """Write what two models, one of them with more friction, predict of the made dataset."""
    rough = Model((Estimate("friction_coefficient", 0.2, "1", "given"),))
    tsas.predict([Model(()), rough], dataset, out=folder, fit_own=False)
    return folder


def write_stage(folder: Path, kind, dataset: Path | None = None, **content) -> Path:
    """Write what a stage says under its file's name, with what every stage says."""
    about = {"format": 1, "stage": kind.model_fields["stage"].default, "version": "0.1.0"}
    if dataset is not None:
        about["dataset"] = source(dataset, folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / kind.FILE).write_text(json.dumps(about | content), encoding="utf-8")
    return folder
