"""What a fault of the recording by one unit does to the residuals of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.identification.run_simulation import Predictions, predict_driven
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import low_pass, new_memory
from tsas_cli.support.arrays import Floats, Indices

WINDOWS = 24  # parts of a run whose zero or gain may differ
RATES = tuple(sign * rate for rate in (0.001, 0.002, 0.003, 0.004, 0.005) for sign in (-1.0, 1.0))
LATE_S = tuple(sign * 0.01 * 2.0**k for k in range(7) for sign in (-1.0, 1.0))  # to 0.64 s
SMALL = 5.0  # times the noise of a driving end: the step that its columns are calculated with


@dataclass(frozen=True, eq=False)
class ReadRun:
    """A run at a trial's rig, and what a wrong reading of a channel does to its residuals."""

    errors: RunErrors
    rig: Rig
    predicted: Predictions

    @property
    def time_s(self) -> Floats:
        """Time since the start of the run [s], shape (n,)."""
        return np.asarray(self.errors.run.time_s - self.errors.run.time_s[0])

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that may be wrong: those of the residuals, then the driving one."""
        drive = self.errors.run.drive_column
        return (*self.errors.samples, *(() if drive in self.errors.samples else (drive,)))

    def values(self, name: str) -> Floats:
        """Return what a channel reads without a fault, shape (n,)."""
        if name in self.errors.samples:
            return self.predicted[name]
        return self.errors.run.conditioned[name].values

    def changed(self, name: str, reading: Floats) -> Floats:
        """Return the change of the residuals where a channel reads so much more, shape (r,)."""
        if name in self.errors.samples:
            return self.errors.changed({name: -reading})
        largest = float(np.abs(reading).max())
        if largest == 0.0:
            return self.errors.changed({})
        conditioned = self.errors.run.conditioned[name]
        size = SMALL * max(conditioned.noise, 1e-4) / largest
        moved = predict_driven(
            self.errors.simulation, self.rig, values=conditioned.values + size * reading
        )
        changes = {name: (moved[name] - self.predicted[name]) / size for name in moved}
        return self.errors.changed(changes)

    def changed_in(
        self, name: str, reading: Floats, first_s: float | None, last_s: float | None
    ) -> Floats:
        """Return the change of the residuals where that is so in a part of the run, shape (r,)."""
        since = self.changed(name, reading * (self.time_s >= (first_s or 0.0)))
        if last_s is None:
            return since
        return since - self.changed(name, reading * (self.time_s >= last_s))

    def late(self, name: str, late_s: float | Floats) -> Floats:
        """Return how much more a channel reads that comes late by that, shape (n,)."""
        values = self.values(name)
        return np.interp(self.time_s - late_s, self.time_s, values) - values

    def lagging(self, name: str, constant_s: float) -> Floats:
        """Return how much more a channel reads behind a low pass, shape (n,)."""
        values = self.values(name)
        return -passed(self.time_s, values - values[0], constant_s)

    @property
    def starts(self) -> Indices:
        """The first sample of each part of the run, shape (parts,)."""
        return np.linspace(0, self.time_s.size, WINDOWS + 1).astype(int)[:-1]

    def since(self, name: str, reading: Floats) -> Floats:
        """Return `changed` where that is so since the start of each part, shape (r, parts)."""
        later = np.arange(self.time_s.size) >= self.starts[:, None]
        return np.column_stack([self.changed(name, reading * own) for own in later])


@dataclass(frozen=True, eq=False)
class RunShapes:
    """The changes of a run's residuals by a fault of one unit in each channel.

    `offset` and `gain` have a column for each of the parts of the run that begin at `starts_s`,
    shape (r, parts); `late` and `pace` are those of a delay of 1 s and of a clock that gains 1 s
    per second, shape (r,); `clocked` of a clock by its pace: a steep channel is no straight line
    over a large shift.
    """

    starts_s: Floats
    offset: Mapping[str, Floats]
    gain: Mapping[str, Floats]
    late: Mapping[str, Floats]
    pace: Mapping[str, Floats]
    clocked: Mapping[str, Mapping[float, Floats]]

    def at_pace(self, channels: Iterable[str], rate: float) -> Floats:
        """Return the column of channels on a clock of a pace, shape (r,)."""
        return np.asarray(np.sum([self.clocked[name][rate] for name in channels], axis=0))


def runs_at(bench: Bench, trial: HypothesisFit) -> list[ReadRun]:
    """Return the runs of a bench at a trial's rigs."""
    rigs = (bench.rig(trial, k) for k in range(len(bench.rigs)))
    pairs = zip(bench.errors_for(trial), rigs, strict=True)
    return [ReadRun(errors, rig, errors.predict(rig)) for errors, rig in pairs]


def shapes_of(read: ReadRun) -> RunShapes:
    """Return what faults of a run do to its residuals."""
    time_s = read.time_s
    offset, gain, late, pace, clocked = {}, {}, {}, {}, {}
    for name in read.channels:
        values = read.values(name)
        speed = np.gradient(values, time_s)
        offset[name] = _parts(read.since(name, np.ones(time_s.size)))
        gain[name] = _parts(read.since(name, values))
        late[name] = read.changed(name, -speed)
        pace[name] = read.changed(name, speed * time_s)
        if name in read.errors.samples:
            clocked[name] = {
                rate: read.changed(name, read.late(name, -rate * time_s)) for rate in RATES
            }
    return RunShapes(time_s[read.starts], offset, gain, late, pace, clocked)


def passed(time_s: Floats, values: Floats, constant_s: float) -> Floats:
    """Return what an amplifier passes that is coupled to AC with a time constant.

    It is connected at the first sample, which it passes whole.
    """
    settled = low_pass(values, time_s, constant_s, new_memory()[0])
    return np.asarray(values - settled + values[0] * np.exp((time_s[0] - time_s) / constant_s))


def _parts(since: Floats) -> Floats:
    """Return the columns of the parts from those of all that follow, shape (r, parts)."""
    return since - np.pad(since[:, 1:], ((0, 0), (0, 1)))
