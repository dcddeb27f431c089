"""Which faults of recording a set hides, how large, and what is right to say of each.

Size 5 and 15 are about how many times the noise the fault is in effect, with 0.1 N and 0.01 mm of
noise, forces of 45 N that change by 25 N/s and positions that move at 8 mm/s (RMS).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tsas_studies.challenge.near import stream

RECORDING_SIZES = (5.0, 15.0)
POSITIONS, FORCES = ("x_in_mm", "x_out_mm"), ("f_in_N", "f_out_N")
ALL = (*POSITIONS, *FORCES)
NOISE = {"x_in_mm": 0.01, "x_out_mm": 0.01, "f_in_N": 0.1, "f_out_N": 0.1}
LEVEL = {"x_in_mm": 12.0, "x_out_mm": 11.0, "f_in_N": 45.0, "f_out_N": 40.0}
RATE = {"x_in_mm": 8.0, "x_out_mm": 7.5, "f_in_N": 25.0, "f_out_N": 12.0}
RUNS = ("b", "c", "d")
LASTS_S = 20.0
GROUPS = (("f_in_N",), ("f_out_N",), ("x_out_mm",), FORCES, ("x_out_mm", "f_out_N"))
# Codes of checks and of the diagnosis, and effects of the catalogue, that are the fault.
SLOW = ("filtered", "repeated-values", "slow-channel", "sensor_lag", "run-lag")
OF_A_RUN = ("run-gain", "run-offset", "run-step")
CLOCK = ("clock", "delay", "run-delay")


@dataclass(frozen=True)
class RecordingFault:
    """A fault of recording as a set names it: the rig's function, its values, and right answers."""

    function: str
    values: Callable[[float, np.random.Generator], dict[str, Any]]
    right: tuple[str, ...]
    sizes: tuple[float, ...] = RECORDING_SIZES


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice((-1.0, 1.0)))


def _one_of(rng: np.random.Generator, names: tuple[Any, ...]) -> Any:
    return names[int(rng.integers(len(names)))]


def _cut_off(size: float, rng: np.random.Generator) -> float:
    return float(rng.uniform(6.0, 10.0) if size == min(RECORDING_SIZES) else rng.uniform(3.0, 6.0))


def _filtering(function: str, *, of_all: bool = False) -> RecordingFault:
    """Return a filter of one channel, or one of all."""

    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        found: dict[str, Any] = {"channels": ALL if of_all else (_one_of(rng, ALL),)}
        if function == "median":
            return found | {"window_s": 1.0 / _cut_off(size, rng)}
        if function == "low_pass":
            found["order"] = int(rng.integers(1, 3))
        return found | {"cut_Hz": _cut_off(size, rng)}

    return RecordingFault(function, values, SLOW)


def _of_a_run(
    function: str,
    what: str,
    channels: tuple[str, ...],
    **parts: tuple[float, float],
) -> RecordingFault:
    """Return a fault of one channel in one run; `parts` are bounds of shares of its time."""

    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        channel = _one_of(rng, channels)
        amount = _sign(rng) * size * NOISE[channel]
        value = 1.0 + amount / LEVEL[channel] if what == "gain" else amount
        shares = {name: float(rng.uniform(*bounds)) for name, bounds in parts.items()}
        return {"run": _one_of(rng, RUNS), "channel": channel, what: value, **shares}

    return RecordingFault(function, values, OF_A_RUN)


def _late(size: float, rng: np.random.Generator) -> dict[str, Any]:
    channel = _one_of(rng, ALL)
    late_s = _sign(rng) * size * NOISE[channel] / RATE[channel]
    return {"run": _one_of(rng, RUNS), "channels": (channel,), "late_s": late_s}


def _pace(run: bool) -> Callable[[float, np.random.Generator], dict[str, Any]]:
    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        channels = _one_of(rng, GROUPS)
        late_s = size * NOISE[channels[0]] / RATE[channels[0]]
        rate = _sign(rng) * min(late_s / (LASTS_S / 3.0), 0.005)
        return {"run": _one_of(rng, RUNS) if run else None, "channels": channels, "rate": rate}

    return values


def _saturated(size: float, rng: np.random.Generator) -> dict[str, Any]:
    return {
        "channels": (_one_of(rng, FORCES),),
        "depth": 0.4 * size,
        "knee": float(rng.uniform(1.0, 2.0)),
    }


def _missed(size: float, rng: np.random.Generator) -> dict[str, Any]:
    lost_mm = 0.02 * size
    where = {"run": _one_of(rng, RUNS), "channel": _one_of(rng, POSITIONS)}
    return where | {"lost_mm": lost_mm, "times": int(rng.integers(2, 5))}


def _units(
    channels: tuple[tuple[str, ...], ...], factors: tuple[float, ...], right: tuple[str, ...]
) -> RecordingFault:
    def values(_size: float, rng: np.random.Generator) -> dict[str, Any]:
        return {"channels": _one_of(rng, channels), "factor": _one_of(rng, factors)}

    return RecordingFault("scaled", values, right, RECORDING_SIZES[1:])


def _manifest(key: str, run: bool, right: tuple[str, ...]) -> RecordingFault:
    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        factor = (1.0 + 0.02 * size * rng.uniform(0.8, 1.2)) ** _sign(rng)
        return {"run": _one_of(rng, RUNS) if run else None, "key": key, "factor": float(factor)}

    return RecordingFault("wrong_condition", values, right)


def _hum(lowest_Hz: float, highest_Hz: float, right: tuple[str, ...]) -> RecordingFault:
    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        channel = _one_of(rng, ALL)
        amplitude = 1.4 * size * NOISE[channel]
        frequency_Hz = float(rng.uniform(lowest_Hz, highest_Hz))
        return {"channels": (channel,), "amplitude": amplitude, "frequency_Hz": frequency_Hz}

    return RecordingFault("hum", values, right)


def _added(
    function: str,
    what: str,
    full: float,
    channels: tuple[tuple[str, ...], ...],
    right: tuple[str, ...],
    **more: Any,
) -> RecordingFault:
    """Return what is added to channels: so much for each size, in units of their noise."""

    def values(size: float, rng: np.random.Generator) -> dict[str, Any]:
        names = _one_of(rng, channels)
        return {"channels": names, what: full * size * NOISE[names[0]], **more}

    return RecordingFault(function, values, right)


def _each(names: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    return tuple((name,) for name in names)


RECORDING_FAULTS: Mapping[str, RecordingFault] = {
    "zero_phase_low_pass": _filtering("zero_phase_low_pass"),
    "zero_phase_low_pass_of_all": _filtering("zero_phase_low_pass", of_all=True),
    "causal_low_pass": _filtering("low_pass"),
    "causal_low_pass_of_all": _filtering("low_pass", of_all=True),
    "median_filter": _filtering("median"),
    "ac_coupled_amplifier": RecordingFault(
        "ac_coupled",
        lambda size, rng: {"channels": (_one_of(rng, FORCES),), "time_s": 300.0 / size},
        ("ac-coupled",),
    ),
    "held_at_20_Hz": RecordingFault(
        "held",
        lambda _size, rng: {"channels": (_one_of(rng, ALL),), "rate_Hz": 20.0},
        SLOW,
        RECORDING_SIZES[1:],
    ),
    "gain_of_a_run": _of_a_run("run_gain", "gain", ALL),
    "gain_of_a_run_since": _of_a_run("run_gain", "gain", ALL, since=(0.3, 0.7)),
    "offset_of_a_run": _of_a_run("run_offset", "offset", FORCES),
    "step_in_a_run": _of_a_run("run_offset", "offset", ("x_out_mm", *FORCES), since=(0.2, 0.8)),
    "bump_in_a_run": _of_a_run(
        "run_offset", "offset", ALL, since=(0.2, 0.5), until=(0.55, 0.75)
    ),
    "slipped_encoder": _of_a_run(
        "run_offset", "offset", ("x_in_mm",), since=(0.2, 0.8)
    ),
    "missed_counts": RecordingFault("missed_counts", _missed, OF_A_RUN),
    "clock_of_a_run": RecordingFault("run_clock", _pace(True), CLOCK),
    "shifted_start_of_a_run": RecordingFault("run_clock", _late, CLOCK),
    "second_logger": RecordingFault("run_clock", _pace(False), CLOCK),
    "lost_samples": RecordingFault(
        "lost_samples",
        lambda size, _rng: {"lost_s": 0.006 * size, "times": 2, "run": None},
        ("lost-samples", "gap"),
    ),
    "lost_samples_in_a_run": RecordingFault(
        "lost_samples",
        lambda size, rng: {"lost_s": 0.006 * size, "times": 2, "run": _one_of(rng, RUNS)},
        ("lost-samples", "gap"),
    ),
    "repeated_buffers": RecordingFault(
        "repeated_buffers",
        lambda size, _rng: {"buffer_s": 0.02 * size, "times": 3},
        ("repeated-buffer", "repeated-rows"),
    ),
    "jittered_stamps": RecordingFault(
        "jittered_stamps",
        lambda size, _rng: {"jitter_s": 0.002 * size},
        ("time-jitter", "time-batches", "unsteady-sampling"),
    ),
    "rounded_stamps": RecordingFault(
        "rounded_stamps",
        lambda size, _rng: {"step_s": 0.005 * size},
        ("time-jitter", "time-order", "time-batches"),
    ),
    "unsteady_sampling": RecordingFault(
        "unsteady_sampling",
        lambda size, _rng: {"jitter_s": 0.01 / 8.0 * size},
        ("unsteady-sampling", "time-jitter"),
    ),
    "radius_for_diameter": _units((("x_in_mm",), POSITIONS), (0.5, 2.0), ("unit",)),
    "positions_in_another_unit": _units((POSITIONS,), (0.1, 1.0 / 25.4), ("unit",)),
    "forces_in_another_unit": _units((FORCES,), (1.0 / 4.448, 1.0 / 9.807), ("unit",)),
    "soft_saturation": RecordingFault(
        "soft_saturation", _saturated, ("clipped", "saturates", "force_sensor_curvature")
    ),
    "noise_after_clipping": RecordingFault(
        "noisy_clipping",
        lambda size, rng: {"channels": (_one_of(rng, FORCES),), "depth": 0.4 * size, "noise": 0.1},
        ("clipped", "saturates"),
    ),
    "sensor_hysteresis": _added(
        "sensor_hysteresis", "share", 0.1, _each(FORCES),
        ("force_sensor_hysteresis", "friction-like-sensor"),
    ),
    "sensor_creep": RecordingFault(
        "sensor_creep",
        lambda size, rng: {"channels": (_one_of(rng, FORCES),), "share": 0.006 * size},
        ("sensor-creep", "force_sensor_hysteresis"),
    ),
    "crosstalk": RecordingFault(
        "crosstalk",
        lambda size, rng: {"channel": _one_of(rng, FORCES), "share": 0.0033 * size},
        ("force_crosstalk",),
    ),
    "random_walk": _added("random_walk", "per_root_s", 0.4, _each((*FORCES, "x_out_mm")),
                          ("wanders", "force_sensor_drift")),
    "hum_in_the_band": _hum(1.0, 8.0, ("hum",)),
    "hum_at_the_motion": _hum(0.155, 0.165, ("hum", "wanders")),
    "bend_of_a_run": _manifest("total_bend_rad", True, ("manifest-run", "run-friction")),
    "length_of_a_run": _manifest("sheath_length_mm", True, ("manifest-run", "run-length")),
    "length_of_all_runs": _manifest(
        "sheath_length_mm", False, ("sheath_compression", "manifest-unit", "data-sheet")
    ),
    "interference_of_the_motor": _added(
        "sign_interference", "amplitude", 1.0, (("f_in_N",), ("f_out_N",), FORCES),
        ("interference", "drive_friction"),
    ),
    "outliers_of_3_percent": _added("outliers", "size", 1.5, _each(ALL), ("outlier",), share=0.03),
    "bursts": _added("bursts", "noise", 1.5, _each(ALL), ("bursts",), lasts_s=0.4, times=4),
}  # fmt: skip


def drawn_recording(fault: str, size: float, seed: int) -> dict[str, Any]:
    """Return the parameters of a fault of recording at a size."""
    rng = stream(seed, f"recording {fault} {size:g}")
    return RECORDING_FAULTS[fault].values(size, rng)
