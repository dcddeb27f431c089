"""The checks of a recording that is too long for memory: stretch by stretch.

Noise, steps, span and extremes are those of the whole run. A stretch is looked at with all its
rows; what is found in one is told, and in how many it is found. What the motion shows (signs,
units, exchanged sensors, steady motion) is looked for in the run thinned to as many rows as a
stretch has, as long as a stroke of the drive keeps more rows in it than a stretch holds strokes.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.recordings import pieces as reading
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Rig
from tsas_cli.recordings.pieces import known_columns, pieces
from tsas_cli.recordings.quality.checks import (
    exchanged,
    few_reversals,
    negative_tension,
    no_steady_motion,
    quantised,
    sign,
    unit,
)
from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.samples import span_of, step_of
from tsas_cli.recordings.quality.trial import Overall, Trial
from tsas_cli.recordings.recording import Floats, Recording
from tsas_cli.recordings.run_files import RunColumns

Said = list[Remark | CannotTell]

_NUMBER = r"-?\d[\d.,e+-]*( \w+)?"
OVERLAP = 16  # of a stretch, the part in which the next one begins
_WHOLE = (quantised.CHECK, few_reversals.CHECK)  # what the thinned run always shows
_MOTION = (
    sign.CHECK,
    negative_tension.CHECK,
    exchanged.CHECK,
    unit.CHECK,
    no_steady_motion.CHECK,
)


def look(check: Check[Trial], trial: Trial) -> Said:
    """Return what a check says of a trial; that it cannot tell, where a column is not there."""
    missing = [name for name in check.needs if name not in trial.channels]
    if missing:
        return [CannotTell(f"{' and '.join(missing)} not recorded")]
    with np.errstate(all="ignore"):  # a stray 1e300 is judged like any other number
        return list(check.find(trial))


def look_by_stretches(checks: Sequence[Check[Trial]], run: RunColumns, rig: Rig) -> dict[str, Said]:
    """Return by code what the checks say of a long run.

    Raises
    ------
    InputError
        It cannot be read.
    """
    overall, thinned = _overview(run)
    whole = Trial(Recording(run.run, thinned), rig, overall)
    by_whole = (*_WHOLE, *_MOTION) if _shows_strokes(whole, run) else _WHOLE
    said: dict[str, list[tuple[str, Said]]] = {check.code: [] for check in checks}
    for piece in pieces(
        run, known_columns(run), overlap=reading.MOST_ROWS // OVERLAP, strict=False
    ):
        trial = Trial(Recording(run.run, piece.columns), rig, overall, piece.start)
        rows = f"rows {piece.start} to {piece.stop - 1}"
        for check in checks:
            if check not in by_whole:
                said[check.code].append((rows, look(check, trial)))
    return {
        check.code: look(check, whole) if check in by_whole else _together(said[check.code])
        for check in checks
    }


def _shows_strokes(whole: Trial, run: RunColumns) -> bool:
    """Say whether a stroke keeps more rows in the thinned run than a stretch holds strokes."""
    strokes, rows = len(whole.strokes), whole.time_s.size
    return strokes * strokes <= rows * run.rows / reading.MOST_ROWS


def _together(stretches: Sequence[tuple[str, Said]]) -> Said:
    """Return what a check says of a run, from what it says of its stretches."""
    if not any(_remarks(said) for _, said in stretches):
        silent = [[one for one in said if isinstance(one, CannotTell)] for _, said in stretches]
        return list(silent[0]) if all(silent) else []
    found: dict[str, list[tuple[str, Remark]]] = {}
    for rows, said in stretches:
        for remark in _remarks(said):
            found.setdefault(_but_for_numbers(remark), []).append((rows, remark))
    return [_of_several(alike, len(stretches)) for alike in found.values()]


def _of_several(alike: Sequence[tuple[str, Remark]], stretches: int) -> Remark:
    """Return the first of remarks that differ by their numbers, with how often there is one."""
    rows, first = alike[0]
    count = len(dict(alike))
    return replace(
        first, sentence=f"{first.sentence} ({rows}; in {count} of {stretches} stretches of the run)"
    )


def _remarks(said: Said) -> list[Remark]:
    return [one for one in said if isinstance(one, Remark)]


def _but_for_numbers(remark: Remark) -> str:
    """Return what a remark says without its numbers and the words after them (one, or many)."""
    return f"{remark.column} {re.sub(_NUMBER, '', remark.sentence)}"


def _overview(run: RunColumns) -> tuple[Overall, dict[str, Floats]]:
    """Return what the whole run shows, and its columns thinned to the rows of a piece."""
    names = known_columns(run)
    every = -(-run.rows // reading.MOST_ROWS)
    thinned: dict[str, list[Floats]] = {name: [] for name in names}
    there: dict[str, list[Floats]] = {name: [] for name in names}
    noise: dict[str, list[float]] = {name: [] for name in names}
    ends: dict[str, list[float]] = {name: [] for name in names}
    for piece in pieces(run, names, strict=False):
        for name, values in piece.columns.items():
            thinned[name].append(values[-piece.start % every :: every].copy())
            finite = values[np.isfinite(values)]
            there[name].append(finite[::every].copy())
            if finite.size:
                noise[name].append(noise_sd(finite))
                ends[name] += [float(finite.min()), float(finite.max())]
    seen = {
        name: np.concatenate(parts) for name, parts in there.items() if name != TIME and ends[name]
    }
    overall = Overall(
        {name: _median(noise[name]) for name in seen},
        {name: step_of(values) for name, values in seen.items()},
        {name: span_of(values) for name, values in seen.items()},
        {name: min(ends[name]) for name in seen},
        {name: max(ends[name]) for name in seen},
    )
    return overall, {name: np.concatenate(parts) for name, parts in thinned.items()}


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if not math.isnan(value)]
    return float(np.median(known)) if known else math.nan
