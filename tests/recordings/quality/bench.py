"""A plain tendon-sheath bench for the checks: one elastic tendon that slips at a capstan."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tsas_cli.recordings.manifest import RigSheet, Run
from tsas_cli.recordings.quality import RUN_CHECKS, look
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.arrays import Floats

STIFFNESS, LOAD, PRELOAD, FRICTION = 100.0, 1.5, 25.0, 0.4  # N/mm, N/mm, N, μθ


@dataclass(frozen=True)
class Bench:
    """How a run is made; the defaults are an ordinary one."""

    shape: str = "sine"
    rate_Hz: float = 200.0
    duration_s: float = 16.0
    amplitude_mm: float = 10.0
    noise_mm: float = 0.01
    noise_N: float = 0.1
    step_mm: float = 0.0
    step_N: float = 0.0
    load: str = "spring"
    seed: int = 0


def motion(bench: Bench, time: Floats) -> Floats:
    """Return x_in [mm], 0 at the start and pulled first."""
    a, t = bench.amplitude_mm, time
    phase = {"chirp": 0.8 * t + 0.12 * t**2, "ramp": 0.0 * t}.get(bench.shape, 1.6 * t)
    wave = 0.5 * (1.0 - np.cos(phase))
    if bench.shape == "triangle":
        wave = np.arccos(np.cos(phase)) / math.pi
    elif bench.shape == "dwells":
        wave = np.clip(2.0 * wave - 0.5, 0.0, 1.0)
    elif bench.shape == "nested":
        wave = wave + 0.12 * (1.0 - np.cos(7.0 * phase))
    elif bench.shape == "decaying":
        wave = 0.5 + (wave - 0.5) * np.exp(-t / 8.0)
    elif bench.shape == "ramp":
        wave = t / t[-1]
    return 2.0 * a * wave


def columns(bench: Bench) -> dict[str, Floats]:
    """Return what the sensors of a bench record."""
    time = np.arange(int(bench.duration_s * bench.rate_Hz)) / bench.rate_Hz
    x_in = motion(bench, time)
    x_out, f_in, f_out = _LOADS[bench.load](x_in, time)
    rng = np.random.default_rng(bench.seed)
    true = {"x_in_mm": x_in, "x_out_mm": x_out, "f_in_N": f_in, "f_out_N": f_out}
    noise = {"mm": bench.noise_mm, "N": bench.noise_N}
    step = {"mm": bench.step_mm, "N": bench.step_N}
    measured = {"time_s": time}
    for name, values in true.items():
        unit = name.rsplit("_", 1)[1]
        values = values + noise[unit] * rng.standard_normal(values.size)
        measured[name] = np.round(values / step[unit]) * step[unit] if step[unit] else values
    return measured


def spring(x_in: Floats, time: Floats) -> tuple[Floats, Floats, Floats]:
    """Return x_out, f_in and f_out of a load like a spring."""
    up, down = math.exp(FRICTION), math.exp(-FRICTION)
    x_out, out = 0.0, np.empty_like(x_in)
    for i, x in enumerate(x_in):
        highest = (PRELOAD * (1 - down) + STIFFNESS * x) / (STIFFNESS + LOAD * down)
        lowest = (PRELOAD * (1 - up) + STIFFNESS * x) / (STIFFNESS + LOAD * up)
        x_out = min(max(x_out, lowest), highest)
        out[i] = x_out
    return out, PRELOAD + STIFFNESS * (x_in - out), PRELOAD + LOAD * out


def _force(x_in: Floats, time: Floats) -> tuple[Floats, Floats, Floats]:
    f_out = 30.0 + 3.0 * np.sin(0.7 * time)
    x_out, f_in = np.empty_like(x_in), np.empty_like(x_in)
    stretch = 30.0 / STIFFNESS
    last = x_in[0]
    for i, x in enumerate(x_in):
        tension = STIFFNESS * (stretch + x - last)
        tension = min(max(tension, f_out[i] * math.exp(-FRICTION)), f_out[i] * math.exp(FRICTION))
        stretch, last, f_in[i] = tension / STIFFNESS, x, tension
        x_out[i] = x - stretch + 0.3
    return x_out, f_in, f_out


def _displacement(x_in: Floats, time: Floats) -> tuple[Floats, Floats, Floats]:
    f_in = PRELOAD + 2.0 * x_in  # the distal end is held: a soft tendon takes up the motion
    f_out, level = np.empty_like(f_in), PRELOAD
    for i, tension in enumerate(f_in):
        level = min(max(level, tension * math.exp(-0.1)), tension * math.exp(0.1))
        f_out[i] = level
    return np.zeros_like(x_in), f_in, f_out


_LOADS = {"spring": spring, "force": _force, "displacement": _displacement}


def trial(
    measured: Mapping[str, Floats], rig: Mapping[str, Any] | None = None, **run: Any
) -> RunSignals:
    """Return a run as the checks see it."""
    entry = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64, **run}
    recording = Recording(Run.model_validate(entry), dict(measured))
    return RunSignals(recording, RigSheet.model_validate(dict(rig or {})))


def remarks(measured: Mapping[str, Floats], **run: Any) -> list[tuple[str, Finding]]:
    """Return what the checks of a run remark, each with the check's code."""
    subject = trial(measured, {"load_stiffness_N_per_mm": LOAD}, **run)
    return [
        (check.code, remark)
        for check in RUN_CHECKS
        for remark in look(check, subject)
        if isinstance(remark, Finding)
    ]
