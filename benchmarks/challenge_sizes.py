"""How much each hidden effect of the blind benchmark shows beyond a refit of the nominal model.

The independent rig itself is refitted to its own clean recordings with the effect in them:
friction, load stiffness, tendon modulus and preload of all runs, and the zero of x_in of each
run, by Gauss-Newton steps with finite differences. What is left is in the unit of the channel,
RMS over all runs. The full sizes in tsas_studies/challenge/cases.py are chosen by it.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from benchmarks.row import Row
from tsas_studies.challenge.bench import RUNS, SENSORS, Bench, clean_run, drawn_bench, rig_of
from tsas_studies.challenge.bench import motion as motion_of
from tsas_studies.challenge.cases import FULL, Hidden, cases
from tsas_studies.challenge.rig.motions import Motion
from tsas_studies.challenge.rig.sensors import Sensor, Sensors
from tsas_studies.challenge.rig.sensors import measure as measured
from tsas_studies.challenge.rig.tendon import simulate
from tsas_studies.challenge.truth import BEYOND

RATE_HZ = 50.0
SIZE = {"f_in_N": 0.1, "f_out_N": 0.1, "x_out_mm": 0.01}  # weights of the refit: the noise
STEP = 1e-3  # of a parameter, relative
ZERO_STEP_MM = 5e-3
ITERATIONS = 3


def left(hidden: Hidden, bench: Bench) -> Mapping[str, float]:
    """Return by channel the RMS that a refit leaves of an effect [N, mm]."""
    wanted = {run: _with(bench, hidden, run) for run in RUNS}
    nominal, zeros = dict(bench.nominal), dict.fromkeys(RUNS, 0.0)
    for _ in range(ITERATIONS):
        model = {run: _without(bench, nominal, zeros[run], run) for run in RUNS}
        slopes = [
            {run: (_without(bench, more, zeros[run], run) - model[run]) / STEP for run in RUNS}
            for more in ({**nominal, name: v * (1.0 + STEP)} for name, v in nominal.items())
        ]
        shifts = {
            run: (_without(bench, nominal, zeros[run] + ZERO_STEP_MM, run) - model[run])
            / ZERO_STEP_MM
            for run in RUNS
        }
        columns = [np.concatenate(list(slope.values())) for slope in slopes]
        for run in RUNS:
            parts = [shifts[r] if r == run else np.zeros(model[r].size) for r in RUNS]
            columns.append(np.concatenate(parts))
        misfit = np.concatenate([wanted[run] - model[run] for run in RUNS])
        change = np.linalg.lstsq(np.stack(columns, axis=1), misfit)[0]
        nominal = {n: v * (1.0 + c) for (n, v), c in zip(nominal.items(), change[:4], strict=True)}
        zeros = {run: zeros[run] + c for run, c in zip(RUNS, change[4:], strict=True)}
    misfit = np.concatenate(
        [(wanted[r] - _without(bench, nominal, zeros[r], r)).reshape(3, -1) for r in RUNS], axis=1
    )
    rms = np.sqrt(np.mean(misfit**2, axis=1))
    return {c: float(value * SIZE[c]) for c, value in zip(SIZE, rms, strict=True)}


def _with(bench: Bench, hidden: Hidden, run: str) -> np.ndarray:
    clean, sensors = clean_run(bench, (hidden,), run, rate_Hz=RATE_HZ)
    return _weighted(measured(clean, _noiseless(sensors), seed=0))


def _without(bench: Bench, nominal: Mapping[str, float], zero: float, run: str) -> np.ndarray:
    m = motion_of(run, 2.0 * RATE_HZ)
    rig = rig_of(replace(bench, nominal=nominal), run)
    clean = simulate(rig, Motion(m.time_s, m.x_in_mm + zero))
    return _weighted(measured(clean, replace(_noiseless(SENSORS), rate_Hz=RATE_HZ), seed=0))


def _noiseless(sensors: Sensors) -> Sensors:
    def quiet(sensor: Sensor) -> Sensor:
        return replace(sensor, noise=0.0, step=0.0)

    channels = {name: quiet(getattr(sensors, name)) for name in (*SIZE, "x_in_mm")}
    return replace(sensors, jitter_s=0.0, **channels)


def _weighted(columns: Mapping[str, np.ndarray]) -> np.ndarray:
    return np.concatenate([columns[c] / size for c, size in SIZE.items()])


def shown(seed: int = 0) -> Iterable[tuple[Hidden, Mapping[str, float]]]:
    """Yield every variant at full size, and the causes outside the catalogue, with what is left."""
    bench = drawn_bench(np.random.default_rng(seed))
    full = [Hidden(effect, variant) for effect, variants in FULL.items() for variant in variants]
    beyond = [
        case.hidden[0]
        for case in cases(seed)
        if case.conditions == "clean" and case.kind in BEYOND
        if case.size == 1.0 and len(case.hidden) == 1
    ]
    for hidden in (*full, *beyond):
        yield hidden, left(hidden, bench)


def measure() -> Iterable[Row]:
    """Yield by variant the largest of f_in, f_out and x_out, with 0.1 mm counted as 1 N."""
    for hidden, rms in shown():
        varied = ", ".join(n for n, v in hidden.parameters.items() if v)
        value = max(rms["f_in_N"], rms["f_out_N"], 10.0 * rms["x_out_mm"])
        limits = {} if hidden.cause == "sheath_compression" else {"at_least": 0.3, "at_most": 1.1}
        yield Row(f"{hidden.cause} ({varied})", value, "N", **limits)
