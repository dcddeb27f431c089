"""A channel was low-pass filtered before it was recorded, slowly enough to delay the motion.

White noise of a sensor reaches up to half the sampling rate. Behind a filter it ends at a lower
frequency, and what is recorded above is the rounding of the converter, or nothing. A filter
delays the channel, or rounds off its corners, so that friction, backlash and delays are not those
of the rig. Reported where the noise falls thirtyfold towards the highest frequencies, and a filter
that ends there would change the channel by more than ten times its noise. Not reported: noise that
grows slower towards low frequencies, a fast amplifier, a recording without noise.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.checks.slow_channel import is_held
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import NoiseSpectrum, noise_spectrum
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_SEGMENT_S, _OF_A_STROKE = 1.0, 0.5  # length of a segment, at most
_FALLS = 30.0  # power of the noise over that at the highest frequencies
_TOP = 0.7  # of the highest frequency: where that is taken
_MIDDLE = (0.3, 0.5)  # of it: where white noise is as large as at the top
_WHITE = 2.5  # times the power at the top, from which it is not white there
_ROUNDING = 4.0  # times the power of the converter's rounding
_STEPS, _COMPUTED = 0.45, 3e-5  # of a step, and of the span: less is rounding, or no sensor's
_FLOOR = 0.1  # of the rounding: below, nothing is rounded
_EVEN, _FEWEST_BANDS = 5.0, 3  # the noise below the end of a filter, within a factor, in bands
_MATTERS = 10.0  # times the noise
_REMEDY = "record without the filter, or with one that is ten times as fast for all channels"


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels whose noise ends far below half the sampling rate."""
    if not trial.increases or not trial.strokes:
        yield CannotTell("time does not increase, or the drive does not move")
        return
    segment_s = min(_SEGMENT_S, _OF_A_STROKE * trial.stroke_s)
    for name, values in trial.mechanical.items():
        whole = np.isfinite(values).all() and trial.moves(name) and not is_held(values)
        spectrum = noise_spectrum(trial.time_s, values, segment_s) if whole else None
        end_Hz = None if spectrum is None else _end_of_noise(spectrum, _rounding(trial, name))
        if end_Hz is None or spectrum is None:
            continue
        noise, size = _noise(spectrum, end_Hz), trial.sizes[name]
        wrong = _change(trial.time_s, values, end_Hz)
        if noise > max(_STEPS * size.step, _COMPUTED * size.span) and wrong > _MATTERS * noise:
            yield Remark(
                "warning",
                f"the noise of {name} ends at about {end_Hz:.2g} Hz, as behind a low-pass filter "
                f"(the sampling rate is {1.0 / trial.step_s:.4g} Hz)",
                _REMEDY,
                name,
            )


def _end_of_noise(spectrum: NoiseSpectrum, rounding: float) -> float | None:
    """Return the frequency above which there is no noise [Hz]; None where it reaches the top."""
    share = spectrum.frequency_Hz / spectrum.frequency_Hz[-1]
    top = float(np.median(spectrum.power[share >= _TOP]))
    middle = spectrum.power[(share >= _MIDDLE[0]) & (share <= _MIDDLE[1])]
    white = middle.size == 0 or float(np.median(middle)) < _WHITE * top
    if white and top > _ROUNDING * rounding:
        return None
    noisy = spectrum.is_noise & (spectrum.power > _FALLS * top)
    if not noisy.any():
        return None
    highest = float(spectrum.power[noisy].max())
    plateau = np.count_nonzero(noisy & (spectrum.power > highest / _EVEN)) >= _FEWEST_BANDS
    if not plateau and (rounding == 0.0 or top < _FLOOR * rounding):
        return None  # a computed recording: what is left of a smooth motion falls all the way
    level = float(np.median(spectrum.power[noisy]))
    return float(spectrum.frequency_Hz[spectrum.is_noise & (spectrum.power > 0.5 * level)].max())


def _rounding(trial: RunSignals, name: str) -> float:
    """Return the power per hertz of the rounding of a channel [unit²/Hz]."""
    return trial.sizes[name].step ** 2 / 6.0 * trial.step_s


def _noise(spectrum: NoiseSpectrum, end_Hz: float) -> float:
    """Return the standard deviation of the noise up to a frequency."""
    below = spectrum.is_noise & (spectrum.frequency_Hz <= end_Hz)
    return float(np.sqrt(np.median(spectrum.power[below]) * end_Hz))


def _change(time_s: Floats, values: Floats, end_Hz: float) -> float:
    """Return the RMS change of a channel by a delay of a filter that ends there."""
    delay_s = 1.0 / (2.0 * np.pi * end_Hz)
    return float(np.sqrt(np.mean((np.interp(time_s - delay_s, time_s, values) - values) ** 2)))


CHECK = QualityCheck("filtered", find)
