"""What the sensors make of a clean run: noise, drift, quantisation, delay, jitter, sample rate."""

from dataclasses import dataclass, field

import numpy as np
from scipy.signal import lfilter

from tsas_studies.challenge.rig.courses import settled
from tsas_studies.challenge.rig.eccentric import eccentric
from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.tendon import CleanRun
from tsas_studies.challenge.rig.transducers import Transducer, transduced


@dataclass(frozen=True)
class Sensor:
    """One channel's errors, in the channel's unit."""

    noise: float = 0.0  # standard deviation of white noise
    step: float = 0.0  # of quantisation; 0 for none
    slow_noise: float = 0.0  # standard deviation of an added first-order coloured noise
    slow_time_s: float = 1.0  # its correlation time
    delay_s: float = 0.0  # how much later than the clock says the channel shows a value
    gain: float = 1.0  # the reading is gain × value + offset
    offset: float = 0.0
    rate_per_s: float = 0.0  # of an offset that grows at first at this rate
    session_rate_per_s: float = 0.0  # of one that each run starts with
    settling_per_s: float = 0.0  # how fast that settles
    hum: float = 0.0  # amplitude of a sine that is picked up
    hum_Hz: float = 3.0
    hum_phase_rad: float = 0.0  # at the start
    # Moments [s] and what the reading is off by from then on; 0 before the first.
    jumps: tuple[tuple[float, float], ...] = ()
    gain_rate_per_s: float = 0.0  # at which the gain grows
    curvature: float = 0.0  # a scale that is bent: curvature × value² is added
    # An eccentric scale: wave × sin(2π value / period + phase) is added, and without a phase a
    # cosine that is zero at the origin, and a second harmonic, shares of the first.
    wave: float = 0.0
    wave_period: float = 5.0
    wave_phase_rad: float = 0.0
    wave_cosine: float = 0.0
    wave_second_sine: float = 0.0
    wave_second_cosine: float = 0.0


_POSITION, _FORCE = Sensor(noise=0.005, step=0.002), Sensor(noise=0.08, step=0.01)


@dataclass(frozen=True)
class Sensors:
    """The sensors of a rig: one per column, and the sampling that they share.

    `jitter_s` is the standard deviation of the true sampling instants about the clock that is
    written down; it is cut off so that instants stay in order. `f_in_of_f_out` is the share of
    f_out that the sensor of f_in picks up, and the other way round. `f_in_tilt_per_mm` is
    the change of the gain of f_in with x_in, that of f_out with x_out. `transducers` are what
    channels do before they are sampled. `session_s` is the start of the run since that of the
    first one.
    """

    rate_Hz: float = 1000.0
    jitter_s: float = 0.0
    x_in_mm: Sensor = _POSITION
    x_out_mm: Sensor = _POSITION
    f_in_N: Sensor = _FORCE
    f_out_N: Sensor = _FORCE
    motor_speed_rpm: Sensor = field(default_factory=Sensor)
    f_in_of_f_out: float = 0.0
    f_out_of_f_in: float = 0.0
    f_in_tilt_per_mm: float = 0.0
    f_out_tilt_per_mm: float = 0.0
    x_in_transducer: Transducer = field(default_factory=Transducer)
    x_out_transducer: Transducer = field(default_factory=Transducer)
    f_in_transducer: Transducer = field(default_factory=Transducer)
    f_out_transducer: Transducer = field(default_factory=Transducer)
    session_s: float = 0.0


PERFECT = Sensors(x_in_mm=Sensor(), x_out_mm=Sensor(), f_in_N=Sensor(), f_out_N=Sensor())


def measure(clean: CleanRun, sensors: Sensors, *, seed: int) -> dict[str, Floats]:
    """Return the recording of a clean run, as columns of format 1.

    The clean run is computed once; another seed gives another recording of it.
    """
    rng = np.random.default_rng(seed)
    end = clean.time_s[-1]
    time_s = np.round(
        np.arange(int(np.floor(end * sensors.rate_Hz + 1e-6)) + 1) / sensors.rate_Hz, 9
    )
    limit = 0.45 / sensors.rate_Hz
    instants = time_s + np.clip(sensors.jitter_s * rng.standard_normal(time_s.size), -limit, limit)
    columns = {"time_s": time_s}
    for name, values in _sensed(clean, sensors).items():
        if name != "time_s":
            sensor = getattr(sensors, name)
            true = np.interp(instants - sensor.delay_s, clean.time_s, values)
            wrong = _systematic(true, sensor, instants)
            wrong = wrong + sensor.session_rate_per_s * sensors.session_s
            columns[name] = _read_out(wrong, sensor, sensors.rate_Hz, rng)
    return columns


def _sensed(clean: CleanRun, sensors: Sensors) -> dict[str, Floats]:
    """Return what the sensors make of a clean run before they are sampled."""
    true, columns = clean.columns, dict(clean.columns)
    for force, other, share, place, tilt_per_mm in (
        ("f_in_N", "f_out_N", sensors.f_in_of_f_out, "x_in_mm", sensors.f_in_tilt_per_mm),
        ("f_out_N", "f_in_N", sensors.f_out_of_f_in, "x_out_mm", sensors.f_out_tilt_per_mm),
    ):
        if share:
            columns[force] = columns[force] + share * true[other]
        if tilt_per_mm:
            columns[force] = columns[force] * (1.0 + tilt_per_mm * true[place])
    for name, transducer in (
        ("x_in_mm", sensors.x_in_transducer),
        ("x_out_mm", sensors.x_out_transducer),
        ("f_in_N", sensors.f_in_transducer),
        ("f_out_N", sensors.f_out_transducer),
    ):
        if name in columns:
            columns[name] = transduced(transducer, clean.time_s, columns[name])
    return columns


def _systematic(true: Floats, sensor: Sensor, instants: Floats) -> Floats:
    """Return what the sensor would read without noise."""
    drift = settled(sensor.rate_per_s, sensor.settling_per_s, instants)
    hum = sensor.hum * np.sin(2.0 * np.pi * sensor.hum_Hz * instants + sensor.hum_phase_rad)
    at = np.array([time for time, _ in sensor.jumps])
    off = np.array([0.0, *(by for _, by in sensor.jumps)])
    lost = off[np.searchsorted(at, instants, side="right")]
    gain = sensor.gain + sensor.gain_rate_per_s * instants
    if sensor.wave_phase_rad == 0.0:
        wave, _ = eccentric(
            true,
            sensor.wave,
            sensor.wave_cosine,
            sensor.wave_period,
            sensor.wave_second_sine,
            sensor.wave_second_cosine,
        )
    else:
        turn = 2.0 * np.pi * true / sensor.wave_period
        wave = sensor.wave * np.sin(turn + sensor.wave_phase_rad)
    bent = sensor.curvature * true**2 + wave
    return np.asarray(gain * true + sensor.offset + drift + hum + lost + bent)


def _read_out(true: Floats, sensor: Sensor, rate_Hz: float, rng: np.random.Generator) -> Floats:
    white = sensor.noise * rng.standard_normal(true.size)
    slow = sensor.slow_noise * _coloured(true.size, sensor.slow_time_s * rate_Hz, rng)
    return quantised(true + white + slow, sensor.step)


def _coloured(size: int, samples: float, rng: np.random.Generator) -> Floats:
    """Return first-order coloured noise of unit variance with a memory of so many samples."""
    keep = np.exp(-1.0 / samples)
    kicks = np.sqrt(1.0 - keep**2) * rng.standard_normal(size)
    kicks[0] = rng.standard_normal()
    return np.asarray(lfilter([1.0], [1.0, -keep], kicks))


def quantised(values: Floats, step: float) -> Floats:
    """Round to multiples of a step, each the nearest float to its decimal text; 0 for no step."""
    if step == 0.0:
        return values
    return np.round(np.round(values / step) * step, 9) + 0.0  # no negative zero
