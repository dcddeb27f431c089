"""Where each side is wrong: the error of each channel over each signal, in the same bins."""

import numpy as np

from tsas_cli.comparing.predictions import Both, ComparedRun
from tsas_cli.diagnosis.residual_map import LABELS, binned, edges_of
from tsas_cli.diagnosis.signals import signals_of
from tsas_cli.records.diagnosis import Maps
from tsas_cli.support.arrays import Floats

Errors = dict[tuple[str, str], tuple[Floats, Floats]]  # by channel and signal: signal, error


def residual_maps(recordings: list[Both]) -> dict[str, Maps]:
    """Return under `a` and `b`, per channel and signal, bins with mean and scatter of the error.

    The error is measured less simulated, in units of the channel's noise; the bins hold about as
    many samples of both sides together. Taken are the recordings that both sides one to; where
    there is none, each side's own. A channel or signal that one side lacks is left out.
    """
    shared = [both for both in recordings if both.a and both.b] or recordings
    a = _collected([both.a for both in shared if both.a])
    b = _collected([both.b for both in shared if both.b])
    out: dict[str, Maps] = {"a": {}, "b": {}}
    for channel, signal in (key for key in a if key in b):
        edges = edges_of(np.concatenate((a[channel, signal][0], b[channel, signal][0])), signal)
        bins = [binned(*side[channel, signal], edges, signal) for side in (a, b)]
        if signal in LABELS and len(bins[0]) != len(bins[1]):
            continue
        if all(bins):
            for side, of_side in zip(("a", "b"), bins, strict=True):
                out[side].setdefault(channel, {})[signal] = of_side
    return out if out["a"] else {}


def _collected(compared: list[ComparedRun]) -> Errors:
    """Return the errors of all runs over each signal, where both are numbers."""
    parts: dict[tuple[str, str], list[tuple[Floats, Floats]]] = {}
    for one in compared:
        signals = signals_of(one.run, one.f_in_N)
        for channel, error in one.errors.items():
            noise = one.noise(channel)
            if not noise:
                continue
            for name, signal in signals.items():
                there = np.isfinite(signal) & np.isfinite(error)
                part = signal[there], error[there] / noise
                parts.setdefault((channel, name), []).append(part)
    joined = {
        key: (np.concatenate([s for s, _ in some]), np.concatenate([e for _, e in some]))
        for key, some in parts.items()
    }
    return {key: both for key, both in joined.items() if both[0].size}
