"""Samples of a run in the joint fit: those compared, those simulated, those left out."""

from collections.abc import Mapping

import numpy as np

from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.response import first_determined_sample
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Indices

MOST_MEANS = 1000  # means of neighbouring residuals that enter the fit, for a channel of a run
FEWEST_SAMPLES = 16  # of a channel, after the start of a run
PER_STROKE = 300  # simulated samples, at least
SHARP = 4  # strides after a reversal in which every sample is simulated


def mean_edges(size: int) -> Indices:
    """Return the first sample of each mean of neighbouring samples."""
    return np.arange(0, size, max(1, -(-size // MOST_MEANS)))


def points(run: Prepared) -> Indices:
    """Return the samples simulated by a chain: some of each stroke, and all after a reversal.

    They are four times as many as means, or more for many strokes. The model depends on the path
    alone, and its prediction has a kink at a reversal.
    """
    n = run.time_s.size
    reversals = run.conditioned[run.drive_column].reversals
    stride = max(1, n // max(4 * MOST_MEANS, PER_STROKE * (reversals.size - 1)))
    followed = np.arange(n) % stride == 0
    for reversal in reversals:  # the last sample is one of them
        followed[reversal : reversal + SHARP * stride] = True
    return np.flatnonzero(followed)


def fitted_samples(run: Prepared, rig: Rig) -> dict[str, Indices]:
    """Return the samples of each channel that enter the fit, none where there are too few.

    They start where the prediction is independent of the history before the run and the drive has
    travelled as far again, as other parameters may need. Samples after the last motion beyond the
    noise are left out. The channel's noise must be known.
    """
    first = first_determined_sample(rig, run.drive)
    if first is None:
        return {}
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(run.drive.values)))))
    usable = ~run.in_gap & (travel >= 2.0 * travel[first])
    drive = run.conditioned[run.drive_column]
    moving = np.flatnonzero(np.abs(drive.values - drive.values[-1]) > drive.smallest_reversal)
    if moving.size:
        usable[moving[-1] + 1 :] = False
    used = {
        name: np.flatnonzero(usable & np.isfinite(measured))
        for name, measured in run.measured.items()
        if run.noise[name] > 0.0
    }
    return {name: at for name, at in used.items() if at.size >= FEWEST_SAMPLES}


def left_out_notes(run: Prepared, samples: Mapping[str, Indices]) -> list[str]:
    """Return a sentence for each channel or run that does not enter the fit."""
    flat = [name for name, noise in run.noise.items() if noise == 0.0]
    short = [name for name in run.measured if name not in samples and name not in flat]
    notes = [f"{name} of run {run.run.id} does not enter the fit: it is constant." for name in flat]
    if not samples and short:
        notes.append(
            f"Run {run.run.id} does not enter the fit: too few samples after the first full slip, "
            "before which its prediction depends on the unknown history."
        )
        return notes
    return notes + [
        f"{name} of run {run.run.id} does not enter the fit: it has too few samples."
        for name in short
    ]
