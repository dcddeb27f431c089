"""The checks of a recording that is too long for memory: stretch by stretch.

Noise, quantisation, span and extremes are those of the whole run. A stretch is checked with all its
rows; a finding states the number of stretches with it. Properties of the motion (signs, units,
exchanged sensors, steady motion) are checked on the run decimated to the rows of one stretch, as
long as a decimated stroke of the drive has more rows than a stretch has strokes.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.recordings import pieces as reading
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import RigSheet
from tsas_cli.recordings.pieces import known_columns, pieces
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import span_of, step_of
from tsas_cli.recordings.quality.trial import RunSignals, Size
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import RunColumns
from tsas_cli.support.arrays import Floats

Results = list[Remark | CannotTell]

_NUMBER = r"-?\d[\d.,e+-]*( \w+)?"
OVERLAP = 16  # consecutive stretches share one in so many of their rows


def look(check: QualityCheck[RunSignals], trial: RunSignals) -> Results:
    """Return the results of a check on a trial; a missing column is a reason not to apply."""
    missing = [name for name in check.needs if name not in trial.channels]
    if missing:
        return [CannotTell(f"{' and '.join(missing)} not recorded")]
    with np.errstate(all="ignore"):  # a stray 1e300 may overflow
        return list(check.find(trial))


def look_by_stretches(
    checks: Sequence[QualityCheck[RunSignals]], run: RunColumns, rig: RigSheet
) -> dict[str, Results]:
    """Return the results of the checks on a long run, by code."""
    overall, decimated = _overview(run)
    whole = RunSignals(Recording(run.run, decimated), rig, overall)
    decimatable = {"decimated", "strokes"} if _shows_strokes(whole, run) else {"decimated"}
    results: dict[str, list[tuple[str, Results]]] = {
        check.code: [] for check in checks if check.of_long not in decimatable
    }
    for piece in pieces(
        run, known_columns(run), overlap=reading.MOST_ROWS // OVERLAP, strict=False
    ):
        trial = RunSignals(Recording(run.run, piece.columns), rig, overall, piece.start)
        rows = f"rows {piece.start} to {piece.stop - 1}"
        for check in checks:
            if check.code in results:
                results[check.code].append((rows, look(check, trial)))
    return {
        check.code: _merged(results[check.code]) if check.code in results else look(check, whole)
        for check in checks
    }


def _shows_strokes(whole: RunSignals, run: RunColumns) -> bool:
    """Return whether a decimated stroke has more rows than a stretch has strokes."""
    strokes, rows = len(whole.strokes), whole.time_s.size
    return strokes * strokes <= rows * run.rows / reading.MOST_ROWS


def _merged(stretches: Sequence[tuple[str, Results]]) -> Results:
    """Return the results of a check on a run, from those on its stretches."""
    if not any(_remarks(results) for _, results in stretches):
        reasons = [[r for r in results if isinstance(r, CannotTell)] for _, results in stretches]
        return list(reasons[0]) if all(reasons) else []
    found: dict[str, list[tuple[str, Remark]]] = {}
    for rows, results in stretches:
        for remark in _remarks(results):
            found.setdefault(f"{remark.column} {re.sub(_NUMBER, '', remark.sentence)}", []).append(
                (rows, remark)
            )
    return [_of_several(same, len(stretches)) for same in found.values()]


def _of_several(same: Sequence[tuple[str, Remark]], stretches: int) -> Remark:
    """Return the first of remarks that differ in numbers only, with the number of stretches."""
    rows, first = same[0]
    count = len(dict(same))
    return replace(
        first, sentence=f"{first.sentence} ({rows}; in {count} of {stretches} stretches of the run)"
    )


def _remarks(results: Results) -> list[Remark]:
    return [one for one in results if isinstance(one, Remark)]


def _overview(run: RunColumns) -> tuple[dict[str, Size], dict[str, Floats]]:
    """Return the properties of the whole run, and its columns decimated to the rows of a piece."""
    names = known_columns(run)
    every = -(-run.rows // reading.MOST_ROWS)
    decimated: dict[str, list[Floats]] = {name: [] for name in names}
    valid: dict[str, list[Floats]] = {name: [] for name in names}
    noise: dict[str, list[float]] = {name: [] for name in names}
    ends: dict[str, list[float]] = {name: [] for name in names}
    for piece in pieces(run, names, strict=False):
        for name, values in piece.columns.items():
            decimated[name].append(values[-piece.start % every :: every].copy())
            finite = values[np.isfinite(values)]
            valid[name].append(finite[::every].copy())
            if finite.size:
                noise[name].append(noise_sd(finite))
                ends[name] += [float(finite.min()), float(finite.max())]
    seen = {
        name: np.concatenate(parts) for name, parts in valid.items() if name != TIME and ends[name]
    }
    overall = {
        name: Size(
            _median(noise[name]), step_of(each), span_of(each), min(ends[name]), max(ends[name])
        )
        for name, each in seen.items()
    }
    return overall, {name: np.concatenate(parts) for name, parts in decimated.items()}


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if not math.isnan(value)]
    return float(np.median(known)) if known else math.nan
