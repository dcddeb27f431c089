"""What each side predicts of recordings, and its errors against what was measured."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tsas_cli.comparing.sides import Side, same_runs
from tsas_cli.identification.comparison import compare as simulated
from tsas_cli.identification.own_values import with_own_values
from tsas_cli.identification.prepared import CHANNELS, Prepared, prepare
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.session import seconds_into
from tsas_cli.recordings.storage import Location
from tsas_cli.recordings.writing import check_rows, columns_of, names_of, result_file
from tsas_cli.records.comparison import ErrorRow
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True)
class ComparedRun:
    """One run: the model's tension at the drive, and what it simulates, shape (n,) each."""

    run: Prepared
    f_in_N: Floats
    simulated: dict[str, Floats]

    @cached_property
    def errors(self) -> dict[str, Floats]:
        """Measured less simulated of each channel that has both, shape (n,)."""
        simulated = self.simulated
        return {n: v - simulated[n] for n, v in self.run.measured.items() if n in simulated}

    def rmse(self, channel: str) -> float | None:
        """Return the root mean square of a channel's error, None where it has none."""
        error = self.errors.get(channel)
        if error is None or not np.isfinite(error).any():
            return None
        return float(np.sqrt(np.nanmean(error**2)))

    def noise(self, channel: str) -> float | None:
        """Return the noise of a channel in its unit, None where it is unknown."""
        noise = self.run.noise.get(channel, np.nan)
        return float(noise) if np.isfinite(noise) else None


@dataclass(frozen=True)
class Both:
    """One recording and what the sides compared to it; one of them may be missing."""

    a: ComparedRun | None
    b: ComparedRun | None

    @property
    def ids(self) -> tuple[str | None, str | None]:
        """The run's id in A and in B."""
        one, other = (None if side is None else side.run.run.id for side in (self.a, self.b))
        return one, other

    @property
    def digest(self) -> str:
        """The recording's checksum."""
        compared = self.a or self.b
        return "" if compared is None else compared.run.run.sha256.lower()


class Predictions:
    """Predictions of recordings, each of which is read and prepared once."""

    def __init__(self, step: Steps = NO_PROGRESS) -> None:
        """Take what is called after each run."""
        self._prepared: dict[tuple[Location, Run], Prepared] = {}
        self._step = step

    def of(
        self, side: Side, dataset: Dataset | None, *, fit_own: bool = False
    ) -> list[ComparedRun]:
        """Return what a side predicts of the runs of a dataset, none where it is not there."""
        if dataset is None:
            return []
        start = None if side.model is None else side.model.session_start(dataset.manifest)
        out = []
        for run in dataset.runs:
            key = (dataset.folder.resolve(), run)  # whose conditions a side may have replaced
            if key not in self._prepared:
                self._prepared[key] = prepare(dataset[run.id])
            ready = self._prepared[key]
            if side.model is None:  # what `tsas simulate` has written
                path = result_file(side.path, run.id)
                columns = columns_of(path, names_of(path))
                for values in columns.values():
                    check_rows(path, values.size, ready.time_s.size, stage="`tsas simulate`")
                f_in = columns.get("f_in_N", ready.channel("f_in_N"))
                unknown = np.full(ready.time_s.size, np.nan)
                out.append(ComparedRun(ready, unknown if f_in is None else f_in, columns))
            else:
                model = side.model
                if side.recordings is not None:
                    model = model.for_runs(side.recordings, [run])
                ready = replace(ready, session_s=seconds_into(start, run.started))
                model = with_own_values(model, ready) if fit_own else model
                found = simulated(ready, model, side.dynamics)
                out.append(ComparedRun(ready, found.response.f_in_N, found.channels))
            self._step()
        return out


def matched(a: list[ComparedRun], b: list[ComparedRun]) -> list[Both]:
    """Return the recordings that both compared to, by checksum, then those of A and of B alone."""
    first, second = ({x.run.run.id: x for x in side} for side in (a, b))
    digests = (
        {run: x.run.run.sha256.lower() for run, x in side.items()} for side in (first, second)
    )
    runs = same_runs(*digests)
    both = [Both(first[one], second[other]) for one, other in runs.items()]
    alone = [Both(x, None) for run, x in first.items() if run not in runs]
    return both + alone + [Both(None, x) for run, x in second.items() if run not in runs.values()]


def error_rows(a: Side, b: Side, recordings: list[Both]) -> list[ErrorRow]:
    """Return the errors of every channel of every recording, in the order of the recordings."""
    rows = []
    for both in recordings:
        (run_a, run_b), compared = both.ids, both.a or both.b
        for name in channels(both):
            rmse_a, rmse_b = (None if one is None else one.rmse(name) for one in (both.a, both.b))
            row = ErrorRow(
                run_a=run_a,
                run_b=run_b,
                channel=name,
                unit=BY_NAME[name].unit,
                rmse_a=rmse_a,
                rmse_b=rmse_b,
                noise=None if compared is None else compared.noise(name),
                fitted_a=a.has_seen(both.digest),
                fitted_b=b.has_seen(both.digest),
                ratio=ratio_of(rmse_b, rmse_a),
            )
            rows.append(row)
    return rows


def ratio_of(value: float | None, over: float | None) -> float | None:
    """Return a ratio, None where one of both is not known, or nothing is below."""
    return value / over if value is not None and over else None


def channels(both: Both) -> list[str]:
    """Return the channels of a recording that a side predicts, in their usual order."""
    there = {
        name for compared in (both.a, both.b) if compared is not None for name in compared.errors
    }
    return [name for name in CHANNELS if name in there]
