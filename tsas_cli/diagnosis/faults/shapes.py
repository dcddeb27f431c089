"""What a fault of the recording by one unit does to the residuals of a run."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tsas_cli.identification.extension import Bench, HypothesisFit
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.identification.run_simulation import Predictions, predict_driven
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

WINDOWS = 24  # parts of a run whose zero or gain may differ
CONSTANTS_S = (2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0)  # of amplifiers coupled to AC
RATES = tuple(sign * rate for rate in (0.001, 0.002, 0.003, 0.004, 0.005) for sign in (-1.0, 1.0))
SMALL = 5.0  # times the noise of a driving end: the step that its columns are calculated with


@dataclass(frozen=True, eq=False)
class RunShapes:
    """The changes of a run's residuals by a fault of one unit in each channel.

    `offset` and `gain` have a column for each of the parts of the run that begin at `starts_s`,
    shape (n, parts); `late` and `pace` are those of a delay of 1 s and of a clock that gains 1 s
    per second, shape (n,); `coupled` of an amplifier coupled to AC by its time constant [s], and
    `clocked` of a clock by its pace: a steep channel is no straight line over a large shift.
    """

    starts_s: Floats
    offset: Mapping[str, Floats]
    gain: Mapping[str, Floats]
    late: Mapping[str, Floats]
    pace: Mapping[str, Floats]
    coupled: Mapping[str, Mapping[float, Floats]]
    clocked: Mapping[str, Mapping[float, Floats]]


def shapes_of(bench: Bench, trial: HypothesisFit, k: int) -> RunShapes:
    """Return what faults of run k do to its residuals at a trial's rig."""
    errors, rig = bench.errors_for(trial)[k], bench.rig(trial, k)
    time_s = errors.run.time_s - errors.run.time_s[0]
    predicted = errors.predict(rig)
    edges = np.linspace(0, time_s.size, WINDOWS + 1).astype(int)
    inside = np.zeros((WINDOWS, time_s.size))
    for window, (start, stop) in enumerate(pairwise(edges)):
        inside[window, start:stop] = 1.0
    offset, gain, late, pace = {}, {}, {}, {}
    coupled, clocked = {}, {}
    for name in errors.samples:
        values = predicted[name]
        speed = np.gradient(values, time_s)
        offset[name] = _columns(errors, name, -inside)
        gain[name] = _columns(errors, name, -inside * values)
        late[name] = errors.changed({name: speed})
        pace[name] = errors.changed({name: -speed * time_s})
        clocked[name] = {
            rate: errors.changed({name: values - np.interp((1.0 + rate) * time_s, time_s, values)})
            for rate in RATES
        }
        if name.endswith("_N"):
            coupled[name] = {
                constant: errors.changed({name: values - _coupled(time_s, values, constant)})
                for constant in CONSTANTS_S
            }
    column = errors.run.drive_column
    if column not in errors.samples:
        driven = _Driven(errors, rig, predicted)
        values = errors.run.conditioned[column].values
        since = np.cumsum(inside[::-1], axis=0)[::-1]  # from each start to the end
        speed = np.gradient(values, time_s)
        offset[column] = _parts(np.array([driven.by(s) for s in since]))
        gain[column] = _parts(np.array([driven.by(s * values) for s in since]))
        late[column] = driven.by(-speed)
        pace[column] = driven.by(speed * time_s)
    return RunShapes(time_s[edges[:-1]], offset, gain, late, pace, coupled, clocked)


def _coupled(time_s: Floats, values: Floats, constant_s: float) -> Floats:
    """Return what an amplifier passes that is coupled to AC with a time constant."""
    from scipy.signal import lfilter

    decay = np.exp(-np.diff(time_s).mean() / constant_s)
    return np.asarray(lfilter([1.0, -1.0], [1.0, -decay], values))


def _columns(errors: RunErrors, name: str, changes: Floats) -> Floats:
    return np.array([errors.changed({name: change}) for change in changes]).T


def _parts(since: Floats) -> Floats:
    """Return the columns of the parts, (n, parts), from those of all that follow, (parts, n)."""
    return np.asarray((since - np.vstack((since[1:], np.zeros_like(since[:1])))).T)


@dataclass(frozen=True, eq=False)
class _Driven:
    """The run with another reading of its driving end."""

    errors: RunErrors
    rig: Rig
    predicted: Predictions

    def by(self, reading: Floats) -> Floats:
        """Return the change of the residuals by one unit of a wrong reading, shape (n,)."""
        conditioned = self.errors.run.conditioned[self.errors.run.drive_column]
        largest = float(np.abs(reading).max())
        if largest == 0.0:
            return self.errors.changed({})
        size = SMALL * max(conditioned.noise, 1e-4) / largest
        moved = predict_driven(
            self.errors.simulation, self.rig, values=conditioned.values + size * reading
        )
        changes = {name: (moved[name] - self.predicted[name]) / size for name in moved}
        return self.errors.changed(changes)
