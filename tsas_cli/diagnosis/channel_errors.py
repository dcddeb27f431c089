"""Residual RMS of each channel on held-out data, before and after, in the channel's unit."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.extension import Bench

FAR_OFF = 5.0  # of the noise floor; complete models of distal channels reach 2.2


@dataclass(frozen=True)
class HeldOutErrors:
    """Residual RMS of one channel on held-out data, its noise level and the attainable RMS.

    The attainable one is at least the white noise, and no larger than what is reached.
    """

    rmse_before: float
    rmse_after: float
    noise_floor: float
    attainable: float


def channel_errors(
    bench: Bench,
    before: Mapping[str, float],
    after: Mapping[str, float],
    start: Remainder,
    remaining: Remainder,
) -> dict[str, HeldOutErrors]:
    """Return the residual RMS of each channel on held-out data, with noise and attainable RMS.

    `before` and `after` are the RMS of each channel, of the nominal and of the extended model.
    """
    out = {}
    for name in bench.channels:
        slow = remaining.slow.get(name) if remaining.complete else None
        floor = noise_floor(bench, name, 0.0 if slow is None else slow.ratio)
        noise = noise_floor(bench, name, 0.0)
        attainable = [
            rms * math.sqrt(1.0 - rest.shares[name])
            for rms, rest in ((before[name], start), (after[name], remaining))
        ]
        least = min(max(min(attainable), noise), after[name])
        out[name] = HeldOutErrors(before[name], after[name], floor, least)
    return out


def with_law(
    channels: Mapping[str, HeldOutErrors], reached: Mapping[str, float]
) -> dict[str, HeldOutErrors]:
    """Return the errors with the RMS that a law reaches in each channel in place of the causes'."""
    return {
        name: replace(c, rmse_after=reached[name], attainable=min(c.attainable, reached[name]))
        for name, c in channels.items()
    }


def is_far_off(name: str, errors: HeldOutErrors) -> bool:
    """Return whether a channel is further from the model than its noise floor explains.

    A drive that hunts, or reverses within a count, moves f_in beyond it, and no distal channel.
    """
    return name != "f_in_N" and errors.rmse_after > FAR_OFF * errors.noise_floor


def noise_floor(bench: Bench, name: str, slow: float) -> float:
    """Return the RMS of a channel's residual with a true model, in its unit.

    It is the channel's white noise, slow noise of `slow` times that, and what the noise of the
    driven ends does.
    """
    squares, count = 0.0, 0
    for run, by_ends in zip(bench.closed, bench.by_driven_ends, strict=True):
        if name in run.samples:
            size = run.samples[name].size
            squares += size * run.run.noise[name] ** 2 * (1.0 + slow**2)
            squares += float(by_ends[name] @ by_ends[name])
            count += size
    return math.sqrt(squares / count)
