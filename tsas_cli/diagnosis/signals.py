"""The signals of a run that a residual may depend on, and their names in words."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_simulation import mean_edges
from tsas_cli.support.arrays import Floats

DIRECTION, RUN = "direction", "run"
SIGNALS = {  # in words, and the unit
    "f_in_N": ("tension at the drive", "N"),
    "time_s": ("time in the run", "s"),
    "x_in_mm": ("displacement of the drive", "mm"),
    "speed_mm_per_s": ("speed", "mm/s"),
    "travel_since_reversal_mm": ("travel since the last reversal", "mm"),
    DIRECTION: ("direction", ""),
}


@dataclass(frozen=True)
class AtResiduals:
    """Each signal at each residual of a trial, shape (n,), and the number of its channel."""

    signals: dict[str, Floats]
    channel: npt.NDArray[np.int64]


def signals_at_residuals(bench: Bench, trial: HypothesisFit) -> AtResiduals:
    """Return the signals in the middle of the samples of each residual of a trial."""
    out: dict[str, list[Floats]] = {}
    for k, run in enumerate(bench.errors_for(trial)):
        predicted = run.predict(bench.rig(trial, k))
        signals = signals_of(run.run, predicted["f_in_N"])
        for at in run.samples.values():
            edges = mean_edges(at.size)
            middle = at[np.minimum(edges + (edges[1] - edges[0]) // 2, at.size - 1)]
            for signal, values in signals.items():
                out.setdefault(signal, []).append(values[middle])
    joined = {name: np.concatenate(values) for name, values in out.items()}
    return AtResiduals(joined, channel_of_residuals(bench, trial))


def channel_of_residuals(bench: Bench, trial: HypothesisFit) -> npt.NDArray[np.int64]:
    """Return the number of the channel of each residual of a trial, shape (n,)."""
    return np.concatenate(
        [
            np.full(mean_edges(at.size).size, bench.channels.index(name))
            for run in bench.errors_for(trial)
            for name, at in run.samples.items()
        ]
    )


def signals_of(run: Prepared, f_in_N: Floats) -> dict[str, Floats]:
    """Return the signals of a run at all samples, shape (n,) each.

    With a drive by force the signals derived from x_in are left out; `f_in_N` is the model's
    tension at the drive, shape (n,).
    """
    out: dict[str, Floats] = {"f_in_N": f_in_N, "time_s": run.time_s - run.time_s[0]}
    drive = run.conditioned[run.drive_column]
    if run.drive_column == "x_in_mm":
        out["x_in_mm"] = drive.values
        out["speed_mm_per_s"] = np.gradient(drive.values, run.time_s)
        out["travel_since_reversal_mm"] = _since_reversal(drive.values, drive.reversals)
    out[DIRECTION] = _direction(drive.values, drive.reversals)
    return out


def signal_in_words(signal: str) -> str:
    """Return a signal's name in words, for a sentence."""
    name, _, rest = signal.partition(" ")
    words = f"the {SIGNALS[name][0]}" if name in SIGNALS else name
    return f"{words} {rest}".rstrip()


def _since_reversal(values: Floats, reversals: npt.NDArray[np.int64]) -> Floats:
    start = np.searchsorted(reversals, np.arange(values.size), side="right") - 1
    start = np.clip(start, 0, max(reversals.size - 2, 0))
    return np.abs(values - values[reversals[start]])


def _direction(values: Floats, reversals: npt.NDArray[np.int64]) -> Floats:
    """Return +1 while the drive pulls, −1 while it releases."""
    stroke = np.searchsorted(reversals, np.arange(values.size), side="left")
    end = np.clip(stroke, 1, reversals.size - 1)
    return np.where(values[reversals[end]] >= values[reversals[end - 1]], 1.0, -1.0)
