"""Residual maps: the residual of each channel over each signal, in bins."""

from collections.abc import Sequence

import numpy as np

from tsas_cli.diagnosis.signals import DIRECTION, RUN, signals_of
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.records.diagnosis import Bin, Maps
from tsas_cli.support.arrays import Floats

BINS = 12
LABELS = (RUN, DIRECTION)


def residual_map(bench: Bench, trial: HypothesisFit) -> Maps:
    """Return, per channel and signal, the bins with mean and standard deviation of the residual.

    The residual is measured minus simulated, in units of its standard deviation.
    """
    errors: dict[str, list[Floats]] = {}
    signals_by_channel: dict[str, dict[str, list[Floats]]] = {}
    for k, run_errors in enumerate(bench.errors_for(trial)):
        run, rig = run_errors.run, bench.rig(trial, k)
        signals = signals_of(run, run_errors.predict(rig)["f_in_N"])
        signals[RUN] = np.full(run.time_s.size, float(k))
        for channel, values in run_errors.errors(rig).items():
            errors.setdefault(channel, []).append(-values)
            at = run_errors.samples[channel]
            for name, signal in signals.items():
                signals_by_channel.setdefault(channel, {}).setdefault(name, []).append(signal[at])
    ids = [e.run.run.id for e in bench.closed]
    return {
        channel: {
            name: _bins(np.concatenate(parts), np.concatenate(errors[channel]), name, ids)
            for name, parts in signals.items()
        }
        for channel, signals in signals_by_channel.items()
    }


def edges_of(signal: Floats, name: str) -> Floats:
    """Return the edges of bins with equal counts; for labels their values."""
    if name in LABELS:
        return np.unique(signal)
    return np.unique(np.quantile(signal, np.linspace(0.0, 1.0, BINS + 1)))


def binned(
    signal: Floats, error: Floats, edges: Floats, name: str, ids: Sequence[str] = ()
) -> tuple[Bin, ...]:
    """Return the bins between the edges, or one for each label.

    Signal and error have shape (n,). The edges are from `edges_of` for this signal, or for more of
    its samples; `ids` are of the runs, where the signal is the run's number.
    """
    if name in LABELS:
        labels = ids if name == RUN else ["releasing", "pulling"]
        parts = [(labels[int(v if name == RUN else v > 0.0)], signal == v) for v in edges]
    else:
        number = np.clip(np.searchsorted(edges, signal, side="right") - 1, 0, edges.size - 2)
        parts = [
            (f"{edges[i]:.3g} to {edges[i + 1]:.3g}", number == i) for i in range(edges.size - 1)
        ]
    return tuple(
        Bin(
            low=float(signal[part].min()),
            high=float(signal[part].max()),
            label=label,
            mean=float(error[part].mean()),
            sd=float(error[part].std()),
            samples=int(part.sum()),
        )
        for label, part in parts
        if part.any()
    )


def _bins(signal: Floats, error: Floats, name: str, ids: Sequence[str]) -> tuple[Bin, ...]:
    return binned(signal, error, edges_of(signal, name), name, ids)
