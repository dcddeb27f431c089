"""The check for a low-pass filter before the recording."""

import numpy as np

from tsas_cli.recordings.quality.finding import Findings, warning
from tsas_cli.recordings.quality.samples import NoiseSpectrum, is_held, locked_phase, noise_spectrum
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_SEGMENT_S, _OF_A_STROKE = 1.0, 0.5  # length of a segment, at most
_FALLS = 30.0  # power of the noise over that at the highest frequencies
_TOP = 0.7  # of the highest frequency: where that is taken
_MIDDLE = (0.3, 0.5)  # of it: where white noise is as large as at the top
_WHITE = 2.5  # times the power at the top, from which it is not white there
_ROUNDING = 1.4  # times the power of the converter's rounding
_STEPS, _COMPUTED = 0.45, 3e-5  # of a step, and of the span: less is rounding, or no sensor's
_FLOOR = 0.1  # of the rounding: below, nothing is rounded
_EVEN = 5.0  # factor within which the noise below the end of a filter is even,
_FEWEST_BANDS = 2, 3  # in so many bands above rounding, or above nothing: a motion falls all along
_MATTERS = 10.0  # times the noise
_OTHER_TENSION = {"f_in_N": "f_out_N", "f_out_N": "f_in_N"}
_LESS, _STEEP = 0.1, 100.0  # power beside the other tension's noise; fall from there to the top
_LOCKED = 0.2  # phase to another channel; that of independent noises is below a tenth


def filtered(trial: RunSignals) -> Findings:
    """A channel was low-pass filtered before it was recorded, slowly enough to delay the motion.

    White noise of a sensor reaches up to half the sampling rate. Behind a filter it ends at a lower
    frequency, and what is recorded above is the rounding of the converter, or nothing. A filter
    delays the channel, or rounds off its corners, so that friction, backlash and delays are not
    those of the rig. Reported where the noise falls thirtyfold towards the highest frequencies, and
    a filter that ends there would change the channel by more than ten times its noise. What a
    smooth motion leaves falls too, and may be alike in all parts of the run; but it falls slower
    than noise behind a filter, so that the highest frequencies at which anything stands out are
    the motion's then, and differ from part to part. Those of a stroke that repeats are the same in
    all parts, but they are lines, with little between them. An unsteady drive moves the tendon at
    random, up to the frequency that it follows; another channel feels that, but not the noise of a
    sensor. Where a motion hides the end, a tension has far less noise above than the other one, and
    ever less. Not reported: noise that grows slower towards low frequencies, a fast amplifier, a
    recording without noise.
    """
    segment_s = min(_SEGMENT_S, _OF_A_STROKE * trial.stroke_s)
    for name, values in trial.mechanical.items():
        whole = np.isfinite(values).all() and trial.moves(name) and not is_held(values)
        spectrum = noise_spectrum(trial.time_s, values, segment_s) if whole else None
        if spectrum is None:
            continue
        found = _by_itself(trial, name, spectrum, segment_s)
        found = found or _beside_the_other(trial, name, spectrum, segment_s)
        if found is None:
            continue
        (end_Hz, noise), size = found, trial.sizes[name]
        late_s = trial.time_s - 1.0 / (2.0 * np.pi * end_Hz)  # by a filter that ends there
        change = np.interp(late_s, trial.time_s, values) - values
        wrong = float(np.sqrt(np.mean(change**2)))
        if noise > max(_STEPS * size.step, _COMPUTED * size.span) and wrong > _MATTERS * noise:
            yield warning(
                name,
                f"the noise of {name} ends at about {end_Hz:.2g} Hz, as behind a low-pass filter "
                f"(the sampling rate is {1.0 / trial.step_s:.4g} Hz)",
                "record without the filter, or with one that is ten times as fast for all channels",
            )


def _by_itself(
    trial: RunSignals, name: str, spectrum: NoiseSpectrum, segment_s: float
) -> tuple[float, float] | None:
    """Return where the noise of a channel ends [Hz] and its size; None where that is not seen."""
    rounding = trial.sizes[name].step ** 2 / 6.0 * trial.step_s  # its power per hertz [unit²/Hz]
    end_Hz = _end_of_noise(spectrum, rounding)
    if end_Hz is None or _are_lines(trial.mechanical[name], trial.step_s, end_Hz):
        return None
    if _is_felt_elsewhere(trial, name, end_Hz, segment_s):
        return None
    below = spectrum.is_noise & (spectrum.frequency_Hz <= end_Hz)
    return end_Hz, float(np.sqrt(np.median(spectrum.power[below]) * end_Hz))


def _beside_the_other(
    trial: RunSignals, name: str, spectrum: NoiseSpectrum, segment_s: float
) -> tuple[float, float] | None:
    """Return the same of a tension that has far less noise than the other one, and ever less.

    Below the end a motion may hide it; the other sensor's noise is white and tells its level.
    """
    values = trial.mechanical.get(_OTHER_TENSION.get(name, ""))
    if values is None or not np.isfinite(values).all() or is_held(values):
        return None
    other = noise_spectrum(trial.time_s, values, segment_s)
    if other is None:
        return None
    (top, middle), (white, other_middle) = _top_and_middle(spectrum), _top_and_middle(other)
    if other_middle > _WHITE * white or middle > _LESS * white or middle < _STEEP * top:
        return None
    louder = spectrum.frequency_Hz[spectrum.power > _LESS * white]
    if not louder.size:
        return None
    return float(louder[-1]), float(np.sqrt(white * louder[-1]))


def _are_lines(values: Floats, step_s: float, end_Hz: float) -> bool:
    """Return whether what ends at a frequency are lines: in most of its bins little is left."""
    straight = np.linspace(values[0], values[-1], values.size)
    power = np.abs(np.fft.rfft((values - straight) * np.blackman(values.size))) ** 2
    frequency_Hz = np.fft.rfftfreq(values.size, step_s)
    below = power[(frequency_Hz > 0.5 * end_Hz) & (frequency_Hz < end_Hz)]
    top = power[frequency_Hz > _TOP * frequency_Hz[-1]]
    return below.size > 0 and float(np.median(below)) < _FALLS * float(np.median(top))


def _is_felt_elsewhere(trial: RunSignals, name: str, end_Hz: float, segment_s: float) -> bool:
    """Return whether another channel moves along with what ends at a frequency."""
    values = trial.mechanical[name]
    for other, others in trial.mechanical.items():
        if other == name or not np.isfinite(others).all():
            continue
        frequency_Hz, locked = locked_phase(trial.time_s, values, others, segment_s)
        below = (frequency_Hz > 0.5 * end_Hz) & (frequency_Hz <= end_Hz)
        if float(np.median(locked[below])) > _LOCKED:
            return True
    return False


def _end_of_noise(spectrum: NoiseSpectrum, rounding: float) -> float | None:
    """Return the frequency above which there is no noise [Hz]; None where it reaches the top."""
    top, middle = _top_and_middle(spectrum)
    if middle < _WHITE * top and top > _ROUNDING * rounding:
        return None
    stands_out = spectrum.power > _FALLS * top
    highest = float(spectrum.power[stands_out & spectrum.is_noise].max(initial=0.0))
    or_below = spectrum.is_noise | ~stands_out
    noisy = stands_out & np.logical_and.accumulate(or_below[::-1])[::-1]  # and in all bands above
    even = np.count_nonzero(noisy & (spectrum.power > highest / _EVEN))
    computed = rounding == 0.0 or top < _FLOOR * rounding
    if even < _FEWEST_BANDS[computed]:
        return None  # what is left of a smooth motion
    level = float(np.median(spectrum.power[noisy]))
    return float(spectrum.frequency_Hz[spectrum.is_noise & (spectrum.power > 0.5 * level)].max())


def _top_and_middle(spectrum: NoiseSpectrum) -> tuple[float, float]:
    """Return the power at the highest frequencies, and where white noise is as large, or 0."""
    share = spectrum.frequency_Hz / spectrum.frequency_Hz[-1]
    middle = spectrum.power[(share >= _MIDDLE[0]) & (share <= _MIDDLE[1])]
    top = float(np.median(spectrum.power[share >= _TOP]))
    return top, float(np.median(middle)) if middle.size else 0.0
