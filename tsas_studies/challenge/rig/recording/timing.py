"""Rows that are lost or written twice without a trace in the times, and times that are wrong."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import CHANNELS, of_runs
from tsas_studies.challenge.rig.recordings import Run


@of_runs
def lost_samples(old: Run, rng: np.random.Generator, *, lost_s: float, times: int) -> Run:
    """Return a run in which rows are missing, the times running on as if none were."""
    rows = np.arange(old.time_s.size)
    kept = np.ones(rows.size, dtype=bool)
    count = max(round(lost_s / (old.time_s[1] - old.time_s[0])), 1)
    for share in rng.uniform(0.1, 0.9, times):
        kept[int(share * rows.size) :][:count] = False
    return _rows(old, rows[kept])


@of_runs
def repeated_buffers(old: Run, rng: np.random.Generator, *, buffer_s: float, times: int) -> Run:
    """Return a run in which a buffer is written twice, the times running on."""
    rows = np.arange(old.time_s.size)
    count = max(round(buffer_s / (old.time_s[1] - old.time_s[0])), 2)
    for share in np.sort(rng.uniform(0.1, 0.9, times))[::-1]:
        at = int(share * rows.size)
        rows = np.concatenate((rows[: at + count], rows[at : at + count], rows[at + count :]))
    return _rows(old, rows)


@of_runs
def jittered_stamps(old: Run, rng: np.random.Generator, *, jitter_s: float) -> Run:
    """Return a run whose times are those at which a busy computer looked at its clock."""
    step = float(old.time_s[1] - old.time_s[0])
    stamps = old.time_s + jitter_s * np.abs(rng.standard_normal(old.time_s.size))
    stamps = np.maximum.accumulate(stamps) + 1e-3 * step * np.arange(stamps.size)
    return old.having(time_s=np.round(stamps - stamps[0], 9))


@of_runs
def unsteady_sampling(old: Run, rng: np.random.Generator, *, jitter_s: float) -> Run:
    """Return a run that was sampled at other times than the even ones that are written down."""
    at = old.time_s + jitter_s * rng.standard_normal(old.time_s.size)
    return old.having(**{c: np.interp(at, old.time_s, old.columns[c]) for c in CHANNELS})


@of_runs
def rounded_stamps(old: Run, _rng: np.random.Generator, *, step_s: float) -> Run:
    """Return a run whose times were rounded when they were written."""
    return old.having(time_s=np.round(np.round(old.time_s / step_s) * step_s, 9))


def _rows(old: Run, rows: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Run:
    """Return these rows, at even times from the first on."""
    step = float(old.time_s[1] - old.time_s[0])
    columns: dict[str, Floats] = {c: old.columns[c][rows] for c in CHANNELS}
    return old.having(time_s=np.round(step * np.arange(rows.size), 9), **columns)
