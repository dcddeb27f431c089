"""The checks of a channel's noise: outliers, interference from the mains, filters."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.samples import NoiseSpectrum, is_held, locked_phase, noise_spectrum
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import count_of

_ASIDE = 3  # neighbours on each side
_NEAR, _FAR = 3.5, 5.0  # times their usual deviation from their median
_APART = 1.5  # times as many as between these: noise with long tails has fewer
_BEYOND = 3.0  # the same, beyond the neighbours
_RARE, _OFTEN = 0.012, 0.1  # share of all samples
_PARTS, _EVERYWHERE = 20, 0.6  # of the run, and the share of them that holds some


def outlier(trial: RunSignals) -> Findings:
    """Single samples are far from the samples before and after them.

    A bit error on a line, a sentinel for a missing value, a loose plug. One outlier can dominate a
    fit by least squares. Reported are one to three consecutive samples that deviate from both
    neighbours by more than 20 times the noise, ten quantisation steps and a twentieth of the span,
    ten times steeper than the neighbouring samples; and any implausible value, which every other
    stage refuses. Many outliers are a warning: 1 to 10 % of the samples deviate from the median of
    their neighbours by more than five times the noise, in all parts of the run, and fewer by a
    little less; noise with long tails has more of those. Not reported: a lasting step, a fast
    reversal.
    """
    yield from _frequent(trial)
    for name, outlying in trial.outlying.items():
        rows = np.flatnonzero(outlying)
        if rows.size == 0:
            continue
        values = trial.recording.columns[name]
        usual = float(np.nanmedian(values))
        farthest = rows[np.argmax(np.abs(values[rows] / 2.0 - usual / 2.0))]
        plausible = abs(values[farthest]) <= largest(name)
        yield error(
            name,
            f"{name} holds {count_of(rows.size, 'sample')} far from "
            f"{'the samples before and after' if plausible else 'any plausible value'}; the "
            f"farthest is {values[farthest]:.6g} at {trial.time_s[farthest]:.6g} s, "
            f"row {trial.first_row + farthest}",
            "leave these cells empty in the file and ingest again; the stages leave the gap out",
            float(trial.time_s[rows[0]]),
        )


def _frequent(trial: RunSignals) -> Iterator[Finding]:
    """Yield the channels of which many samples deviate from the median of their neighbours."""
    for name, values in trial.noisy.items():
        window = np.lib.stride_tricks.sliding_window_view(values, 2 * _ASIDE + 1)
        means = 0.5 * (window[:, :_ASIDE] + window[:, :_ASIDE:-1])  # free of a straight motion
        deviation = window[:, _ASIDE] - np.median(means, axis=1)
        noise = 1.4826 * float(np.nanmedian(np.abs(deviation)))
        if not noise > 0.0:
            continue
        # A spike lies beyond both of its neighbours, and beyond the lines through two on each side:
        # on a slope one neighbour is above, the other below, and a corner lies on the lines.
        near = window[:, [_ASIDE - 1, _ASIDE + 1]]
        lines = 2.0 * near - window[:, [_ASIDE - 2, _ASIDE + 2]]
        beyond = window[:, [_ASIDE]] - np.hstack((near, lines))
        spike = np.maximum(beyond.min(axis=1), -beyond.max(axis=1)) > _BEYOND * noise
        size = np.where(spike, np.abs(deviation) / noise, 0.0)
        far = size > _FAR
        between = np.count_nonzero((size > _NEAR) & ~far)
        parts = [bool(part.any()) for part in np.array_split(far, _PARTS)]
        if np.count_nonzero(far) < _APART * between:
            continue
        if _RARE < float(far.mean()) < _OFTEN and np.mean(parts) > _EVERYWHERE:
            yield warning(
                name,
                f"{100.0 * far.mean():.2g} % of the samples of {name} deviate from the median of "
                f"their neighbours by more than {_FAR:g} times its noise",
                "look for bit errors and loose plugs; leave these cells empty and ingest again",
            )


_BLOCK = 16  # rows
_TIMES = 4.0  # the usual noise
_IN_A_ROW = 2  # blocks, at least
_MOST = 0.15  # share of the blocks
_REPEATS = 0.02  # share of the rows


def bursts(trial: RunSignals) -> Findings:
    """The noise of a channel rises manifold for short times.

    A radio, a welder, a motor's brake or a loose plug. Reported where a few short stretches have
    four times the noise of the rest of the run. Not reported: a corner where the drive reverses,
    noise that grows with the speed or lasts as long as the motion. A tendon that is shaken, or
    sticks and slips, has such bursts too.
    """
    if float(trial.repeats.mean()) > _REPEATS:
        yield NotChecked("rows repeat")
        return
    turns = np.array([stroke.stop for stroke in trial.strokes], int) // _BLOCK
    corners = np.concatenate((turns - 1, turns, turns + 1))
    for name, values in trial.noisy.items():
        third = np.diff(values, 3)
        third = third[: third.size // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
        if not third.size or is_held(values):
            continue
        level = np.median(np.abs(third), axis=1)
        alternates = np.mean(third[:, 1:] * third[:, :-1] < 0.0, axis=1) > 0.5  # noise, no motion
        loud = alternates & (level > _TIMES * np.median(level))
        beside = np.isin(np.arange(loud.size), corners)
        edges = np.flatnonzero(np.diff(loud.astype(int), prepend=0, append=0))
        bursts = [
            (a, b) for a, b in edges.reshape(-1, 2) if b - a >= _IN_A_ROW and not beside[a:b].all()
        ]
        if bursts and float(loud.mean()) < _MOST:
            start = _BLOCK * int(bursts[0][0])
            more = float(np.median(level[loud]) / np.median(level))
            yield warning(
                name,
                f"the noise of {name} rises to {more:.2g} times its level in "
                f"{count_of(len(bursts), 'burst')}, the first at {trial.time_s[start]:.4g} s",
                "look for what switches or shakes then, shield the cable, or leave these cells out",
                float(trial.time_s[start]),
            )


_HUM_S = 2.0
_LINE_TIMES = 20.0  # the power beside the line
_BESIDE_LINE = 0.35  # of the line's frequency: how far to the sides that is taken


def hum(trial: RunSignals) -> Findings:
    """A channel oscillates at one frequency all the time, whatever the motion.

    Mains hum aliased into the band, an inverter, a fan. Reported where the noise of a channel has
    one narrow line, twenty times as strong as beside it and as strong in every part of the run.
    """
    for name, values in trial.noisy.items():
        spectrum = noise_spectrum(trial.time_s, values, _HUM_S)
        line = None if spectrum is None else _line(spectrum)
        if line is not None:
            yield warning(
                name,
                f"{name} oscillates at about {line:.2g} Hz all the time, whatever the motion",
                "look for hum, aliased perhaps, and for what runs at this frequency; shield the "
                "cable, filter before sampling",
            )


def _line(spectrum: NoiseSpectrum) -> float | None:
    """Return the frequency of a line that stands out from the noise on both of its sides [Hz]."""
    frequency, power = spectrum.frequency_Hz, spectrum.power
    at = int(np.argmax(np.where(spectrum.is_steady, power, 0.0)))
    apart = np.abs(frequency / frequency[at] - 1.0) > _BESIDE_LINE
    below = np.flatnonzero(apart & (frequency < frequency[at]))[-2:]
    above = np.flatnonzero(apart & (frequency > frequency[at]))[:4]
    if not spectrum.is_steady[at] or not below.size or not above.size:
        return None
    stands_out = power[at] > _LINE_TIMES * max(power[below].max(), power[above].max())
    return float(frequency[at]) if stands_out else None


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
