"""Sensor readings of true forces and displacements, and the inverse.

From the true value to the reading: tilt, crosstalk, hysteresis, low pass, delay, curve or wave,
gain and offset with their drifts. Hysteresis and low pass have a memory, which is carried over
where a run is simulated in pieces.
"""

from typing import Literal

import numpy as np

from tsas_cli.effects.force_crosstalk import with_crosstalk
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.effects.force_sensor_drift import drift_reading
from tsas_cli.effects.force_sensor_gain import read_gain
from tsas_cli.effects.force_sensor_gain_drift import drifted_gain
from tsas_cli.effects.force_sensor_hysteresis import read_hysteresis
from tsas_cli.effects.force_sensor_offset import offset_reading
from tsas_cli.effects.force_sensor_tilt import read_tilted
from tsas_cli.effects.position_sensor_gain import read_position
from tsas_cli.effects.position_sensor_ripple import (
    PositionSensorRipple,
    read_rippled,
    without_ripple,
)
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elastoplastic import yielded
from tsas_cli.numerics.settling import lag_after
from tsas_cli.physics.boundary import FORCE, Boundary
from tsas_cli.physics.course import Output
from tsas_cli.physics.end_laws import LAW_MEMORY, with_laws
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

Channel = Literal["f_in_N", "f_out_N", "x_out_mm"]
CHANNELS: tuple[Channel, ...] = ("f_in_N", "f_out_N", "x_out_mm")

# The memory of a channel: of its low pass, of its elastoplastic element, then of the law on it.
TIME, INPUT, BEHIND, ELEMENT_INPUT, ELEMENT_FORCE = range(5)
OWN_MEMORY = 5


def new_memory() -> Floats:
    """Return the memory of the sensors before the first sample of a run.

    For each of `CHANNELS` time [s] and input of its low pass at the last sample, and by how much
    the low pass lags there; input and force of its elastoplastic element; time, input and states of
    the elements of the law that acts on it; shape (3, 17), NaN before the first sample.
    """
    return np.full((len(CHANNELS), OWN_MEMORY + LAW_MEMORY), np.nan)


def sensed(
    output: Output,
    time_s: Floats | None,
    rig: Rig,
    boundary: Boundary,
    memory: Floats,
    motor_mm: Floats | None = None,
) -> Output:
    """Return an output with its signals after laws, tilt, crosstalk, hysteresis and low pass.

    `time_s` are the times of the samples, shape (n,), None for a run without time, which passes no
    filter. A force that is given at the `boundary` is read as it is given, without tilt, crosstalk
    and hysteresis. `memory` is that after the sample before, updated in place. `motor_mm` is
    the motor's displacement, where it was recorded, shape (n,).
    """
    output = with_laws(output, time_s, rig, boundary, memory[:, OWN_MEMORY:], motor_mm)
    f_in, f_out, shares = output.f_in, output.f_out, rig.effects.force_crosstalk
    loops, tilts = rig.effects.force_sensor_hysteresis, rig.effects.force_sensor_tilt
    if boundary.drive != FORCE:
        if tilts.f_in_per_mm != 0.0:
            f_in = tilted(f_in, tilts.f_in_per_mm, output.x_in)
        if shares.f_in_of_f_out != 0.0:
            f_in = f_in + with_crosstalk(0.0, 1.0, shares.f_in_of_f_out) * output.f_out
        if loops.f_in_share != 0.0:
            f_in = with_hysteresis(f_in, loops.f_in_share, loops.span_N, memory[0])
    if boundary.load != FORCE:
        if tilts.f_out_per_mm != 0.0:
            f_out = tilted(f_out, tilts.f_out_per_mm, output.x_out)
        if shares.f_out_of_f_in != 0.0:
            f_out = f_out + with_crosstalk(0.0, 1.0, shares.f_out_of_f_in) * output.f_in
        if loops.f_out_share != 0.0:
            f_out = with_hysteresis(f_out, loops.f_out_share, loops.span_N, memory[1])
    signals = [f_in, f_out, output.x_out]
    if time_s is not None:
        for k, lag_s in enumerate(rig.effects.sensor_lag):
            if lag_s > 0.0:
                signals[k] = low_pass(signals[k], time_s, lag_s, memory[k])
    f_in, f_out, x_out = signals
    return output._replace(f_in=f_in, f_out=f_out, x_out=x_out)


@kernel
def tilted(forces: Floats, per_mm: float, positions: Floats) -> Floats:
    """Return the readings of a sensor that tilts with the position [N]."""
    out = np.empty(forces.size)
    for i in range(forces.size):
        out[i] = read_tilted(forces[i], per_mm, positions[i])
    return out


@kernel
def with_hysteresis(forces: Floats, share: float, span_N: float, memory: Floats) -> Floats:
    """Return forces with a sensor's hysteresis, whose element is without force at the first one.

    `memory` is a channel's row of that of the sensors, updated in place.
    """
    out = np.empty(forces.size)
    before, element_N = memory[ELEMENT_INPUT], memory[ELEMENT_FORCE]
    for i in range(forces.size):
        element_N = 0.0 if np.isnan(before) else yielded(element_N, forces[i] - before, span_N)
        before = forces[i]
        out[i] = read_hysteresis(before, element_N, share)
    memory[ELEMENT_INPUT], memory[ELEMENT_FORCE] = before, element_N
    return out


@kernel
def low_pass(values: Floats, time_s: Floats, lag_s: float, memory: Floats) -> Floats:
    """Return values after a first-order low pass, which starts at rest at the first one.

    `memory` is a channel's row of that of the sensors, updated in place.
    """
    out = np.empty(values.size)
    time, value, behind = memory[TIME], memory[INPUT], memory[BEHIND]
    for i in range(values.size):
        if np.isnan(time):
            behind = 0.0
        else:
            behind = lag_after(behind, values[i] - value, time_s[i] - time, lag_s)
        time, value = time_s[i], values[i]
        out[i] = value - behind
    memory[TIME], memory[INPUT], memory[BEHIND] = time, value, behind
    return out


def reading(channel: Channel, values: Floats, time_s: Floats | None, rig: Rig) -> Floats:
    """Return a channel's readings of signals that passed `sensed`, shape (n,).

    They are delayed, curved, scaled, shifted. Without times there is no delay, no drift.
    """
    delayed = _delayed_by(values, time_s, _delay(channel, rig))
    curvature, ripple = _curvature(channel, rig), _ripple(channel, rig)
    if curvature != 0.0:
        delayed = curved(delayed, curvature)
    if ripple is not None:
        delayed = with_wave(delayed, ripple)
    return delayed * _gain(channel, time_s, rig) + _shift(channel, time_s, rig)


def true_value(channel: Channel, readings: Floats, time_s: Floats | None, rig: Rig) -> Floats:
    """Return the true values of a channel's readings, the inverse of `sensed` and `reading`.

    A low pass is inverted to first order in its time, by the rate of the signal: the exact inverse
    would multiply noise by the square of that time over the sampling period.
    """
    delayed = (readings - _shift(channel, time_s, rig)) / _gain(channel, time_s, rig)
    curvature, ripple = _curvature(channel, rig), _ripple(channel, rig)
    if ripple is not None:
        delayed = without_wave(delayed, ripple)
    if curvature != 0.0:
        delayed = uncurved(delayed, curvature)
    signal = _delayed_by(delayed, time_s, -_delay(channel, rig))
    lag_s = rig.effects.sensor_lag[CHANNELS.index(channel)]
    if lag_s == 0.0 or time_s is None or signal.size < 2:
        return signal
    return signal + lag_s * np.gradient(signal, time_s)


def _delayed_by(values: Floats, time_s: Floats | None, delay_s: float) -> Floats:
    """Return delayed values; the first and the last one are extrapolated as constants."""
    if time_s is None or delay_s == 0.0:
        return values
    return np.interp(time_s - delay_s, time_s, values)


def _delay(channel: Channel, rig: Rig) -> float:
    delays = rig.effects.channel_delay
    return {
        "f_in_N": delays.f_in_delay_s,
        "f_out_N": delays.f_out_delay_s,
        "x_out_mm": delays.x_out_delay_s,
    }[channel]


def _curvature(channel: Channel, rig: Rig) -> float:
    if channel == "x_out_mm":
        return 0.0
    curves = rig.effects.force_sensor_curvature
    return curves.f_in_per_N if channel == "f_in_N" else curves.f_out_per_N


def _ripple(channel: Channel, rig: Rig) -> PositionSensorRipple | None:
    ripple = rig.effects.position_sensor_ripple
    there = channel == "x_out_mm" and (ripple.sine_mm != 0.0 or ripple.cosine_mm != 0.0)
    return ripple if there else None


def _gain(channel: Channel, time_s: Floats | None, rig: Rig) -> Floats | float:
    if channel == "x_out_mm":
        return read_position(1.0, rig.effects.position_sensor_gain.x_out_gain)
    drifts, gain = rig.effects.force_sensor_gain_drift, 1.0
    if channel == "f_out_N":
        gain = read_gain(1.0, rig.effects.force_sensor_gain.f_out_gain)
    rate = drifts.f_in_rate_per_s if channel == "f_in_N" else drifts.f_out_rate_per_s
    if rate == 0.0 or time_s is None:
        return gain
    return drifting_gain(gain, rate, time_s)


def _shift(channel: Channel, time_s: Floats | None, rig: Rig) -> Floats | float:
    """Return the additive error: the zero of a displacement, offset and drift of a force."""
    offset, drift = rig.effects.force_sensor_offset, rig.effects.force_sensor_drift
    if channel == "x_out_mm":
        return rig.x_out_zero_mm
    here = offset.f_in_offset_N if channel == "f_in_N" else offset.f_out_offset_N
    rate = drift.f_in_rate_N_per_s if channel == "f_in_N" else drift.f_out_rate_N_per_s
    start = offset_reading(0.0, here)
    if rate == 0.0 or time_s is None:
        return start
    return drifting(start, rate, drift.settling_per_s, time_s)


@kernel
def curved(forces: Floats, curvature: float) -> Floats:
    """Return the readings of a curved scale [N]."""
    out = np.empty(forces.size)
    for i in range(forces.size):
        out[i] = read_curved(forces[i], curvature)
    return out


@kernel
def uncurved(readings: Floats, curvature: float) -> Floats:
    """Return the forces of the readings of a curved scale [N]."""
    out = np.empty(readings.size)
    for i in range(readings.size):
        out[i] = straightened(readings[i], curvature)
    return out


@kernel
def with_wave(positions: Floats, ripple: PositionSensorRipple) -> Floats:
    """Return the readings of a sensor that turns off its centre [mm]."""
    out = np.empty(positions.size)
    for i in range(positions.size):
        out[i] = read_rippled(positions[i], ripple)
    return out


@kernel
def without_wave(readings: Floats, ripple: PositionSensorRipple) -> Floats:
    """Return the positions of the readings of such a sensor [mm]."""
    out = np.empty(readings.size)
    for i in range(readings.size):
        out[i] = without_ripple(readings[i], ripple)
    return out


@kernel
def drifting_gain(gain: float, rate: float, time_s: Floats) -> Floats:
    """Return a gain that drifts, at each time [1]."""
    out = np.empty(time_s.size)
    for i in range(time_s.size):
        out[i] = drifted_gain(gain, rate, time_s[i])
    return out


@kernel
def drifting(start: float, rate: float, settling_per_s: float, time_s: Floats) -> Floats:
    """Return an offset that drifts, at each time [N]."""
    out = np.empty(time_s.size)
    for i in range(time_s.size):
        out[i] = drift_reading(start, rate, settling_per_s, time_s[i])
    return out
