"""The check of a channel's noise for stretches in which it rises."""

import numpy as np

from tsas_cli.numerics.noise import interpolated
from tsas_cli.recordings.quality.finding import Findings, NotChecked, warning
from tsas_cli.recordings.quality.samples import is_held
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

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
    stops = np.array([stroke.stop for stroke in trial.strokes], int)
    for name, values in trial.noisy.items():
        rows = np.flatnonzero(~interpolated(values))
        turns = np.searchsorted(rows, stops) // _BLOCK
        corners = np.concatenate((turns - 1, turns, turns + 1))
        third = np.diff(values[rows], 3)
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
            start = rows[_BLOCK * int(bursts[0][0])]
            more = float(np.median(level[loud]) / np.median(level))
            yield warning(
                name,
                f"the noise of {name} rises to {more:.2g} times its level in "
                f"{count_of(len(bursts), 'burst')}, the first at {trial.time_s[start]:.4g} s",
                "look for what switches or shakes then, shield the cable, or leave these cells out",
                float(trial.time_s[start]),
            )
