"""Sensor readings of true forces and displacements, and the inverse."""

from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.effects.force_sensor_drift import drift_reading
from tsas_cli.effects.force_sensor_gain import read_gain
from tsas_cli.effects.force_sensor_offset import offset_reading
from tsas_cli.effects.position_sensor_gain import read_position
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Channel = Literal["f_in_N", "f_out_N", "x_out_mm"]


def reading(channel: Channel, values: Floats, time_s: Floats | None, rig: Rig) -> Floats:
    """Return a channel's readings of true values, shape (n,): delayed, scaled, shifted.

    Without times there is no delay and no drift.
    """
    delayed = _delayed_by(values, time_s, _delay(channel, rig))
    return delayed * _gain(channel, rig) + _shift(channel, time_s, rig)


def true_value(channel: Channel, readings: Floats, time_s: Floats | None, rig: Rig) -> Floats:
    """Return the true values of a channel's readings, the inverse of `reading`."""
    delayed = (readings - _shift(channel, time_s, rig)) / _gain(channel, rig)
    return _delayed_by(delayed, time_s, -_delay(channel, rig))


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


def _gain(channel: Channel, rig: Rig) -> float:
    if channel == "f_out_N":
        return read_gain(1.0, rig.effects.force_sensor_gain.f_out_gain)
    if channel == "x_out_mm":
        return read_position(1.0, rig.effects.position_sensor_gain.x_out_gain)
    return 1.0


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
def drifting(start: float, rate: float, settling_per_s: float, time_s: Floats) -> Floats:
    """Return an offset that drifts, at each time [N]."""
    out = np.empty(time_s.size)
    for i in range(time_s.size):
        out[i] = drift_reading(start, rate, settling_per_s, time_s[i])
    return out
