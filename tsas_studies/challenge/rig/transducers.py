"""What happens to a force or a position before it is sampled: filters, hysteresis, play, creep.

All of it acts on the fine clock of a clean run, which starts from rest.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, lfilter, lfilter_zi

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl
from tsas_studies.challenge.rig.drive_end import followed
from tsas_studies.challenge.rig.motions import Floats


@dataclass(frozen=True)
class Transducer:
    """What a channel does to its signal before it is sampled; zeros are nothing, in this order."""

    play: float = 0.0  # between what is measured and the sensor, which starts in its middle
    # While a force changes one way, the reading stays behind by share · span; it turns as Dahl's
    # law over this span.
    hysteresis_share: float = 0.0
    hysteresis_span: float = 10.0
    creep_share: float = 0.0  # so much of a change is read later, within this time
    creep_s: float = 3.0
    lag_s: float = 0.0  # time constant of a first-order low pass
    # 1/(2πf) of a Butterworth filter of second order with the cut-off frequency f.
    filter_s: float = 0.0


def transduced(transducer: Transducer, time_s: Floats, signal: Floats) -> Floats:
    """Return what reaches the converter, shape (m,)."""
    t, out = transducer, signal
    if t.play:
        out = out[0] + followed(out - out[0], t.play)
    if t.hysteresis_share:
        out = out - t.hysteresis_share * t.hysteresis_span * _loop(out, t.hysteresis_span)
    if t.creep_share:
        out = out - t.creep_share * (out - _low_pass(time_s, out, t.creep_s))
    if t.lag_s:
        out = _low_pass(time_s, out, t.lag_s)
    if t.filter_s:
        rate_Hz = 1.0 / (time_s[1] - time_s[0])
        b, a = butter(2, 1.0 / (2.0 * np.pi * t.filter_s), fs=rate_Hz)
        out, _ = lfilter(b, a, out, zi=out[0] * lfilter_zi(b, a))
    return np.asarray(out)


@compiled
def _low_pass(time_s: Floats, signal: Floats, constant: float) -> Floats:
    """Return τ dy/dt + y = signal, the signal linear between its samples; exact, from rest."""
    out = np.empty(signal.size)
    last = signal[0]
    for i in range(signal.size):
        j = max(i, 1)
        h = time_s[j] - time_s[j - 1]
        before, slope = signal[max(i - 1, 0)], (signal[i] - signal[max(i - 1, 0)]) / h
        fades = np.exp(-h / constant)
        last = signal[i] - slope * constant + (last - before + slope * constant) * fades
        out[i] = last
    return out


@compiled
def _loop(signal: Floats, span: float) -> Floats:
    """Return the state of a hysteresis loop at each sample, from −1 to 1, 0 at first."""
    out = np.empty(signal.size)
    state, last = 0.0, signal[0]
    for i in range(signal.size):
        state = dahl(signal[i] - last, state, span, 0.0, 1.0)
        last = signal[i]
        out[i] = state
    return out
