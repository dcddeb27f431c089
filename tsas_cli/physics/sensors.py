"""Sensor readings of true forces and displacements, and the inverse.

From the true value to the reading: tilt, crosstalk, hysteresis, low pass, delay, curve or wave,
gain and offset with their drifts. Hysteresis and low pass have a memory, which is carried over
where a run is simulated in pieces.
"""

from typing import Literal

import numpy as np

from tsas_cli.effects.force_crosstalk import with_crosstalk
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.effects.force_sensor_drift import reading_in_session
from tsas_cli.effects.force_sensor_gain import read_gain
from tsas_cli.effects.force_sensor_gain_drift import drifted_gain
from tsas_cli.effects.force_sensor_hysteresis import read_hysteresis
from tsas_cli.effects.force_sensor_offset import offset_reading
from tsas_cli.effects.force_sensor_tilt import read_tilted
from tsas_cli.effects.laws.drive_law import DriveLaw, drive_law_force
from tsas_cli.effects.laws.load_law import LoadLaw, load_law_motion
from tsas_cli.effects.position_sensor_gain import read_position
from tsas_cli.effects.position_sensor_ripple import without_ripple
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import lag_after
from tsas_cli.numerics.stops import ELEMENTS, GAPS, yielded
from tsas_cli.numerics.wave import Wave, rippled
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, Boundary
from tsas_cli.physics.course import Output
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
    effects, signals = rig.effects, [output.f_in, output.f_out, output.x_out]
    loops = effects.force_sensor_hysteresis
    drive = boundary.drive, output.x_in, output.f_out
    load = boundary.load, output.x_out, output.f_in
    for k, (given, position, other) in enumerate((drive, load)):
        if given == FORCE:
            continue
        if effects.force_sensor_tilt[k] != 0.0:
            signals[k] = read_tilted(signals[k], effects.force_sensor_tilt[k], position)
        if effects.force_crosstalk[k] != 0.0:
            signals[k] = with_crosstalk(signals[k], other, effects.force_crosstalk[k])
        if loops[k] != 0.0:
            signals[k] = with_hysteresis(signals[k], loops[k], loops.span_N, memory[k])
    if time_s is not None:
        for k, lag_s in enumerate(effects.sensor_lag):
            if lag_s > 0.0:
                signals[k] = low_pass(signals[k], time_s, lag_s, memory[k])
    f_in, f_out, x_out = signals
    return output._replace(f_in=f_in, f_out=f_out, x_out=x_out)


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


def reading(
    channel: Channel, values: Floats, time_s: Floats | None, session_s: float, rig: Rig
) -> Floats:
    """Return a channel's readings of signals that passed `sensed`, shape (n,).

    They are delayed, curved, scaled, shifted. Without times there is no delay, no drift within the
    run. `session_s` is the start of the run since that of the first one.
    """
    k = CHANNELS.index(channel)
    delayed = _delayed_by(values, time_s, rig.effects.channel_delay[k])
    if channel == "x_out_mm" and not rig.effects.position_sensor_ripple.is_flat:
        delayed = rippled(delayed, rig.effects.position_sensor_ripple)
    elif channel != "x_out_mm" and rig.effects.force_sensor_curvature[k] != 0.0:
        delayed = read_curved(delayed, rig.effects.force_sensor_curvature[k])
    return delayed * _gain(channel, time_s, rig) + _shift(channel, time_s, session_s, rig)


def true_value(
    channel: Channel, readings: Floats, time_s: Floats | None, session_s: float, rig: Rig
) -> Floats:
    """Return the true values of a channel's readings, the inverse of `sensed` and `reading`.

    A low pass is inverted to first order in its time, by the rate of the signal: the exact inverse
    would multiply noise by the square of that time over the sampling period.
    """
    k = CHANNELS.index(channel)
    shift = _shift(channel, time_s, session_s, rig)
    delayed = (readings - shift) / _gain(channel, time_s, rig)
    if channel == "x_out_mm" and not rig.effects.position_sensor_ripple.is_flat:
        delayed = without_wave(delayed, rig.effects.position_sensor_ripple)
    elif channel != "x_out_mm" and rig.effects.force_sensor_curvature[k] != 0.0:
        delayed = straightened(delayed, rig.effects.force_sensor_curvature[k])
    signal = _delayed_by(delayed, time_s, -rig.effects.channel_delay[k])
    lag_s = rig.effects.sensor_lag[k]
    if lag_s == 0.0 or time_s is None or signal.size < 2:
        return signal
    return signal + lag_s * np.gradient(signal, time_s)


def _delayed_by(values: Floats, time_s: Floats | None, delay_s: float) -> Floats:
    """Return delayed values; the first and the last one are extrapolated as constants."""
    if time_s is None or delay_s == 0.0:
        return values
    return np.interp(time_s - delay_s, time_s, values)


def _gain(channel: Channel, time_s: Floats | None, rig: Rig) -> Floats | float:
    if channel == "x_out_mm":
        return read_position(1.0, rig.effects.position_sensor_gain.x_out_gain)
    gain = read_gain(1.0, rig.effects.force_sensor_gain.f_out_gain) if channel == "f_out_N" else 1.0
    rate = rig.effects.force_sensor_gain_drift[CHANNELS.index(channel)]
    return gain if rate == 0.0 or time_s is None else drifted_gain(gain, rate, time_s)


def _shift(channel: Channel, time_s: Floats | None, session_s: float, rig: Rig) -> Floats | float:
    """Return the additive error: the zero of a displacement, offset and drift of a force."""
    if channel == "x_out_mm":
        return rig.x_out_zero_mm
    k = CHANNELS.index(channel)
    offset = offset_reading(0.0, rig.effects.force_sensor_offset[k])
    return reading_in_session(offset, rig.effects.force_sensor_drift, k, time_s, session_s)


@kernel
def without_wave(readings: Floats, ripple: Wave) -> Floats:
    """Return the positions of the readings of a position sensor that turns off its centre [mm]."""
    out = np.empty(readings.size)
    for i in range(readings.size):
        out[i] = without_ripple(readings[i], ripple)
    return out


NO_DRIVE_LAW, NO_LOAD_LAW = DriveLaw(), LoadLaw()
LAW_MEMORY = 2 + ELEMENTS + GAPS


def with_laws(
    output: Output,
    time_s: Floats | None,
    rig: Rig,
    boundary: Boundary,
    memory: Floats,
    motor_mm: Floats | None,
) -> Output:
    """Return an output with the laws of unnamed origin at both ends, but for a given quantity.

    `memory` has a row for each of f_in, f_out and x_out: time, input and states of the elements of
    the law that acts on it, NaN before the first sample, shape (3, LAW_MEMORY), updated in place.
    """
    effects, f_in, x_out = rig.effects, output.f_in, output.x_out
    if boundary.drive != FORCE and effects.drive_law != NO_DRIVE_LAW:
        moved = output.x_in if motor_mm is None else motor_mm
        speed = backward_rate(moved, time_s, memory[0])
        f_in = f_in + drive_law_force(
            effects.drive_law, output.x_in, moved, speed, f_in, memory[0, 1:]
        )
    if boundary.load != DISPLACEMENT and effects.load_law != NO_LOAD_LAW:
        x_out = x_out + load_law_motion(effects.load_law, x_out, output.f_out, memory[2, 1:])
    return output._replace(f_in=f_in, x_out=x_out)


def backward_rate(values: Floats, time_s: Floats | None, memory: Floats) -> Floats:
    """Return the mean rate of a signal since the sample before, shape (n,), 0 where there is none.

    `memory` has time and value of the sample before; the time is updated in place.
    """
    if time_s is None:
        return np.zeros(values.size)
    before, memory[0] = memory[0], time_s[-1]
    changes, steps_s = np.diff(values, prepend=memory[1]), np.diff(time_s, prepend=before)
    return np.nan_to_num(changes / steps_s, nan=0.0, posinf=0.0, neginf=0.0)
