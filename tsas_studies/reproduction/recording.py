"""A recording of the paper's rig as the distributed model makes it, and the fits made of it."""

from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.base_fit import slopes_of
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import prepare
from tsas_cli.paper import Paper
from tsas_cli.physics.response import simulate
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording
from tsas_studies.reproduction.rig import bench_rig, motion

PERIODS = 3.0  # of which the first, from rest, is left out


@dataclass(frozen=True)
class Noise:
    """Standard deviations of what the sensors add; the paper says nothing about its own."""

    tension_N: float = 0.1
    displacement_mm: float = 0.005


@dataclass(frozen=True)
class Fitted:
    """A phase's slope over many recordings [N/mm]: mean, and standard deviation of one."""

    mean: float
    spread: float


def fitted_stiffness(paper: Paper, noise: Noise, *, seeds: int) -> dict[str, Fitted]:
    """Return km by phase: what `tsas calibrate` fits to recordings of group a at 1 kHz."""
    found = [_slopes(paper, noise, seed) for seed in range(seeds)]
    return {
        phase: Fitted(float(np.mean(values)), float(np.std(values, ddof=1)))
        for phase in found[0]
        for values in [[each[phase] for each in found]]
    }


def _slopes(paper: Paper, noise: Noise, seed: int) -> dict[str, float]:
    rig = bench_rig(paper)
    time_s, drive = motion(paper, "a", periods=PERIODS)
    prediction = simulate(rig, drive)
    steady = slice(int(time_s.size / PERIODS), None)
    random = np.random.default_rng(seed)
    columns = {"time_s": time_s[steady]}
    for name, size in (
        ("x_in_mm", noise.displacement_mm),
        ("x_out_mm", noise.displacement_mm),
        ("f_in_N", noise.tension_N),
        ("f_out_N", noise.tension_N),
    ):
        clean = getattr(prediction, name)[steady]
        columns[name] = clean + size * random.standard_normal(clean.size)
    run = Run(
        id="a",
        file="a.parquet",
        sha256="0" * 64,
        sheath_length_mm=rig.sheath_length_mm,
        total_bend_rad=rig.total_bend_rad,
        preload_N=rig.preload_N,
    )
    prepared = prepare(Recording(run, columns))
    return {slope.phase: slope.value for slope in slopes_of(prepared, segment(prepared))}
