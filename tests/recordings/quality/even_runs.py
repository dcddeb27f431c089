"""Runs whose channels are without fault, but for what a test changes."""

from dataclasses import replace

import numpy as np

from tests.recordings.quality.bench import trial
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.quality.samples import Size

N = 400
WHITE = np.random.default_rng(6).standard_normal(N)
FINE = Size(0.0, 0.0, 10.0, 0.0, 10.0)


def fine(time_s=None, sizes=None, load="spring", preload_N=None, **columns):
    """Return a run; each channel has the span 10, no noise and no steps, but for some sizes."""
    time_s = 0.01 * np.arange(N) if time_s is None else np.asarray(time_s)
    found = trial({"time_s": time_s, **columns}, load=load, preload_N=preload_N)
    return replace(found, overall=dict.fromkeys(columns, FINE) | (sizes or {}))


def of(check, *given, **named):
    """Return the findings of a check on such a run."""
    return [f for f in check(fine(*given, **named)) if isinstance(f, Finding)]


def are(told, found, *said):
    """Hold that there are so many findings, of which each says all that."""
    assert len(told) == found
    assert all(part in f.sentence for f in told for part in said)


X = np.interp(np.arange(N), [0, 100, 200, 300, 399], [0.0, 10.0, 0.0, 10.0, 0.0])
WAY = np.sign(np.gradient(X))
