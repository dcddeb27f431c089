"""Where the simulation is wrong: the error of each channel over each signal, bin by bin."""

from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.signals import DIRECTION, signals_of
from tsas_cli.identification.extension import Bench, Trial

Floats = npt.NDArray[np.float64]

BINS = 12


def residual_map(bench: Bench, trial: Trial) -> dict[str, Any]:
    """Return, per channel and signal, the bins with mean and scatter of the error.

    The error is measured less simulated, in units of what noise explains.
    """
    errors: dict[str, list[Floats]] = {}
    seen: dict[str, dict[str, list[Floats]]] = {}
    for k, run_errors in enumerate(bench.errors_for(trial)):
        run, rig = run_errors.run, bench.rig(trial, k)
        signals = signals_of(run, run_errors.answers(rig)["f_in_N"])
        signals["run"] = np.full(run.time_s.size, float(k))
        for channel, values in run_errors.errors(rig).items():
            errors.setdefault(channel, []).append(-values)
            at = run_errors.samples[channel]
            for name, signal in signals.items():
                seen.setdefault(channel, {}).setdefault(name, []).append(signal[at])
    ids = [e.run.run.id for e in bench.closed]
    return {
        channel: {
            name: _bins(np.concatenate(parts), np.concatenate(errors[channel]), name, ids)
            for name, parts in signals.items()
        }
        for channel, signals in seen.items()
    }


def _bins(signal: Floats, error: Floats, name: str, ids: list[str]) -> list[dict[str, Any]]:
    """Return bins of one signal, with equal counts, or one for each value that is a label."""
    if name in ("run", DIRECTION):
        values = np.unique(signal)
        labels = ids if name == "run" else ["letting go", "pulling"]
        parts = [(labels[int(v if name == "run" else v > 0.0)], signal == v) for v in values]
    else:
        edges = np.unique(np.quantile(signal, np.linspace(0.0, 1.0, BINS + 1)))
        number = np.clip(np.searchsorted(edges, signal, side="right") - 1, 0, edges.size - 2)
        parts = [
            (f"{edges[i]:.3g} to {edges[i + 1]:.3g}", number == i) for i in range(edges.size - 1)
        ]
    return [
        {
            "from": float(signal[part].min()),
            "to": float(signal[part].max()),
            "label": label,
            "mean": float(error[part].mean()),
            "sd": float(error[part].std()),
            "samples": int(part.sum()),
        }
        for label, part in parts
        if part.any()
    ]
