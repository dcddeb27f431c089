"""Which samples of a run enter the joint fit, which a chain follows for it, what is left out."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.response import forgotten
from tsas_cli.physics.rig import Rig

Indices = npt.NDArray[np.int64]

MOST_MEANS = 1000  # means of neighbouring residuals that enter the fit, for a channel of a run
FEWEST_SAMPLES = 16  # of a channel, after the start of a run
OF_A_STROKE = 300  # samples that a chain follows, at least
SHARP = 4  # strides after a reversal in which it follows every sample


def mean_edges(size: int) -> Indices:
    """Return where each mean of neighbouring samples begins."""
    return np.arange(0, size, max(1, -(-size // MOST_MEANS)))


def points(run: Prepared) -> Indices:
    """Return the samples that a chain follows: some of a stroke, and all after a reversal.

    They are four times as many as means, or more where it takes more to see each stroke bend.

    The model depends on the path alone, and at a reversal its prediction bends sharply.
    """
    n = run.time_s.size
    reversals = run.conditioned[run.drive_column].reversals
    stride = max(1, n // max(4 * MOST_MEANS, OF_A_STROKE * (reversals.size - 1)))
    there = np.arange(n) % stride == 0
    for turn in reversals:  # the last sample is one of them
        there[turn : turn + SHARP * stride] = True
    return np.flatnonzero(there)


def kept_samples(run: Prepared, rig: Rig) -> dict[str, Indices]:
    """Return the samples of each channel that enter the fit, none where there are too few.

    They are those after the tendon has forgotten how the run began; to be sure of it with other
    parameters too, the drive must travel as far again. A reversal so near the end that it cannot
    be told from noise is left out with what follows. The channel's noise must be known.
    """
    first = forgotten(rig, run.drive)
    if first is None:
        return {}
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(run.drive.values)))))
    usable = ~run.in_gap & (travel >= 2.0 * travel[first])
    drive = run.conditioned[run.drive_column]
    moving = np.flatnonzero(np.abs(drive.values - drive.values[-1]) > drive.smallest_reversal)
    if moving.size:
        usable[moving[-1] + 1 :] = False
    there = {
        name: np.flatnonzero(usable & np.isfinite(measured))
        for name, measured in run.measured.items()
        if run.noise[name] > 0.0
    }
    return {name: at for name, at in there.items() if at.size >= FEWEST_SAMPLES}


def lost(run: Prepared, samples: Mapping[str, Indices]) -> list[str]:
    """Say what of a run does not enter the fit, and why."""
    flat = [name for name, noise in run.noise.items() if noise == 0.0]
    short = [name for name in run.measured if name not in samples and name not in flat]
    out = [f"{name} of run {run.run.id} does not enter the fit: it never changes." for name in flat]
    if not samples and short:
        out.append(
            f"Run {run.run.id} does not enter the fit: too few samples are left after the whole "
            "tendon has slipped for the first time, which is when it forgets how it began."
        )
        return out
    return out + [
        f"{name} of run {run.run.id} does not enter the fit: it holds too few samples."
        for name in short
    ]
