"""The library of the sparse baseline: terms of recorded signals, and the effect each stands for.

A term is what its effect adds to the channels, to first order and up to a factor: an error of the
drive's displacement goes on by the measured slopes of the channels, a force at the load reaches
f_in by the measured ratio of the tensions, a change of friction grows with tension and bend.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tsas_cli.diagnosis.signals import DIRECTION, signals_of
from tsas_cli.effects.drive_ripple import PERIOD_MM
from tsas_cli.effects.stribeck_friction import STRIBECK_FRICTION
from tsas_cli.identification.prepared import CHANNELS, Prepared
from tsas_cli.numerics.conditioning import condition
from tsas_cli.support.arrays import Floats

STILL = 0.02  # of the greatest speed, below which no slope over the drive is taken
MOST_RATIO = 5.0  # of the tensions, either way
TURN_MM = 0.1  # travel in which friction comes back after a reversal
SETTLING_PER_S = 0.2
LATE_S, LAG_S = 1.0, 0.02  # of a viscoelastic load, of a low pass
PULLEY_MM = 7.0  # of an eccentric pulley
VELOCITY_MM_PER_S = next(p.start for p in STRIBECK_FRICTION.parameters if p.shape)


@dataclass(frozen=True)
class Term:
    """What an effect adds to each channel of a run, shape (n,) each, up to a factor."""

    effect: str
    text: str
    channels: dict[str, Floats]


def terms(run: Prepared) -> Iterator[Term]:
    """Yield the terms of a run that an x_in drives, the same ones in the same order for every run.

    Channels that were not measured are taken as zero.
    """
    t = run.time_s - run.time_s[0]
    clean = {name: _clean(run, name) for name in CHANNELS}
    rates = {name: np.gradient(values, run.time_s) for name, values in clean.items()}
    f_in, f_out, x_out = clean["f_in_N"], clean["f_out_N"], clean["x_out_mm"]
    signals = signals_of(run, f_in)
    x, v, s = signals["x_in_mm"], signals["speed_mm_per_s"], signals[DIRECTION]
    moving = np.abs(v) > STILL * np.abs(v).max()
    slopes = {c: np.divide(r, v, out=np.zeros_like(v), where=moving) for c, r in rates.items()}
    ratio = np.divide(f_in, f_out, out=np.ones_like(f_in), where=f_out > 0.0)
    ratio = np.clip(ratio, 1.0 / MOST_RATIO, MOST_RATIO)
    bend = run.run.total_bend_rad or 1.0
    length = run.run.sheath_length_mm or 1.0
    tension = np.maximum(f_in, 0.0)
    settled = 1.0 - np.exp(-SETTLING_PER_S * t)

    def moved(by: Floats) -> dict[str, Floats]:
        return {channel: slope * by for channel, slope in slopes.items()}

    def pulled(by: Floats) -> dict[str, Floats]:
        return {"f_out_N": by, "f_in_N": ratio * by}

    def rubbed(by: Floats) -> dict[str, Floats]:
        return {"f_in_N": s * tension * by}

    yield Term("backlash", "moved by sign(v)", moved(-s))
    yield Term("drive_friction", "sign(v)", {"f_in_N": s})
    yield Term("drive_ripple", "moved by sin(x)", moved(np.sin(2.0 * np.pi * x / PERIOD_MM)))
    yield Term("drive_ripple", "moved by cos(x)", moved(np.cos(2.0 * np.pi * x / PERIOD_MM)))
    yield Term("drive_damping", "v", {"f_in_N": v})
    yield Term("drive_inertia", "a", {"f_in_N": np.gradient(v, run.time_s)})
    yield Term("drive_compliance", "moved by f_in", moved(-f_in))
    yield Term("proximal_spring", "x", {"f_in_N": x})
    yield Term("free_tendon", "moved by f_out", moved(-f_out))
    yield Term("sheath_compression", "moved by f L", moved(-0.5 * length * (f_in + f_out)))
    second = np.maximum(float(tension.mean()) - tension, 0.0)  # taut where the first one is loose
    yield Term("antagonist", "sign(v) (mean f_in − f_in), if positive", {"f_in_N": s * second})
    yield Term("direction_dependent_friction", "f_in θ", rubbed(s * bend))
    falling = np.exp(-((v / VELOCITY_MM_PER_S) ** 2))
    yield Term("stribeck_friction", "f_in θ sign(v) exp(−v²)", rubbed(bend * falling))
    yield Term("viscous_friction", "v", {"f_in_N": v})
    yield Term("sheath_drag", "(1 + f_in/f_out) sign(v)", {"f_in_N": (1.0 + ratio) * s})
    level = np.log(np.maximum(tension, 0.1) / max(float(tension.mean()), 0.1))
    yield Term("load_dependent_friction", "f_in θ sign(v) log f_in", rubbed(bend * level))
    yield Term("position_dependent_friction", "f_in θ sign(v) x", rubbed(bend * x))
    yield Term("uneven_friction", "f_in θ sign(v) (f_in − f_out)", rubbed(bend * (f_in - f_out)))
    yield Term("pulley_friction", "f_in sign(v)", rubbed(np.ones_like(t)))
    turned = np.exp(-signals["travel_since_reversal_mm"] / TURN_MM)
    yield Term("presliding", "f_in θ sign(v) exp(−travel)", rubbed(-bend * turned))
    yield Term("bend_drift", "f_in sign(v) t", rubbed(t))
    yield Term("bend_drift", "f_in sign(v) (1 − exp(−t))", rubbed(settled))
    yield Term("friction_drift", "f_in θ sign(v) t", rubbed(bend * t))
    yield Term("friction_drift", "f_in θ sign(v) (1 − exp(−t))", rubbed(bend * settled))
    session = np.full_like(t, run.session_s)
    yield Term("friction_drift", "f_in θ sign(v) session", rubbed(bend * session))
    yield Term("preload_loss", "pulled by t", pulled(-t))
    yield Term("preload_loss", "pulled by (1 − exp(−t))", pulled(-settled))
    yield Term("load_spring_nonlinearity", "pulled by x_out²", pulled(x_out**2))
    yield Term("load_spring_nonlinearity", "pulled by x_out³", pulled(x_out**3))
    yield Term("load_friction", "pulled by sign(v)", pulled(s))
    yield Term("load_friction", "f_in/f_out sign(v)", {"f_in_N": ratio * s})
    yield Term("load_inertia", "pulled by a", pulled(np.gradient(rates["x_out_mm"], run.time_s)))
    yield Term("load_damping", "pulled by the speed", pulled(rates["x_out_mm"]))
    travelled = 1.0 - np.exp(-signals["travel_since_reversal_mm"])
    yield Term("load_hysteresis", "pulled by sign(v) (1 − exp(−travel))", pulled(s * travelled))
    late = x_out - lag_of(x_out, run.time_s, LATE_S)
    yield Term("load_relaxation", "pulled by x_out less itself late", pulled(late))
    turn = 2.0 * np.pi * x_out / PULLEY_MM
    yield Term("load_ripple", "pulled by sin(x_out)", pulled(np.sin(turn)))
    yield Term("load_ripple", "pulled by cos(x_out)", pulled(np.cos(turn)))
    yield Term("force_sensor_gain", "f_out", {"f_out_N": f_out})
    yield Term("position_sensor_gain", "x_out", {"x_out_mm": x_out})
    yield Term("position_sensor_ripple", "sin(x_out)", {"x_out_mm": np.sin(turn)})
    yield Term("position_sensor_ripple", "cos(x_out)", {"x_out_mm": np.cos(turn)})
    for channel in ("f_in_N", "f_out_N"):
        yield Term("force_sensor_offset", "1", {channel: np.ones_like(t)})
        yield Term("force_sensor_drift", "t", {channel: t})
        yield Term("force_sensor_drift", "1 − exp(−t)", {channel: settled})
        yield Term("force_sensor_drift", "session", {channel: session})
        other = f_out if channel == "f_in_N" else f_in
        yield Term("force_crosstalk", "the other force", {channel: other})
        yield Term("force_sensor_gain_drift", "its product with t", {channel: clean[channel] * t})
        place = x if channel == "f_in_N" else x_out
        yield Term("force_sensor_tilt", "its product with x", {channel: clean[channel] * place})
        yield Term("force_sensor_curvature", "its square", {channel: clean[channel] ** 2})
        yield Term(
            "force_sensor_hysteresis", "sign of its rate", {channel: -np.sign(rates[channel])}
        )
    for channel, rate in rates.items():
        yield Term("channel_delay", "rate of change", {channel: -rate})
        yield Term(
            "sensor_lag",
            "late",
            {channel: lag_of(clean[channel], run.time_s, LAG_S) - clean[channel]},
        )


def lag_of(values: Floats, time_s: Floats, late_s: float) -> Floats:
    """Return the values behind a first-order low pass, shape (n,)."""
    keep = np.exp(-np.diff(time_s, prepend=time_s[0]) / late_s)
    out = np.empty_like(values)
    last = values[0]
    for i, (value, share) in enumerate(zip(values, keep, strict=True)):
        last = value + share * (last - value)
        out[i] = last
    return out


def _clean(run: Prepared, channel: str) -> Floats:
    measured = run.measured.get(channel)
    if measured is None:
        return np.zeros_like(run.time_s)
    return condition(run.time_s, measured).values
