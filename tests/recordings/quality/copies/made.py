"""Recordings, and what becomes of them on the way into a dataset a second time."""

import numpy as np
from scipy.interpolate import CubicSpline

from tests.recordings.quality.bench import Bench, columns
from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.rig.recordings import Run, write_dataset

CONDITIONS = {"sheath_length_mm": 785.4, "total_bend_rad": 3.1416, "preload_N": 25.0}


def dataset(folder, conditions=None, **runs):
    """Write runs, all under the same conditions but for some, and open them."""
    by_run = conditions or {}
    made = [Run(name, c, CONDITIONS | by_run.get(name, {})) for name, c in runs.items()]
    return read_dataset(write_dataset(folder / "runs", made))


def recorded(seed=0, **bench):
    return columns(Bench(**{"rate_Hz": 100.0, "seed": seed, **bench}))


def rows(run, *between):
    return {name: values[slice(*between)] for name, values in run.items()}


def later(run, by_s):
    return run | {"time_s": run["time_s"] + by_s}


def resampled(run, rate_Hz, *, begin_s=0.003, curve=np.interp):
    time_s = np.arange(begin_s, run["time_s"][-1], 1.0 / rate_Hz)
    return {n: curve(time_s, run["time_s"], v) for n, v in run.items()} | {"time_s": time_s}


def on_spline(at, time_s, values):
    return CubicSpline(time_s, values)(at)


def rounded(run, digits):
    return {n: v if n == "time_s" else np.round(v, digits) for n, v in run.items()}
