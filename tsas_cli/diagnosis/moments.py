"""Errors that neither the mean square nor a regression on the signals shows.

An error with the shape of a misplaced reversal has no weight in a fit, so its mean over the strokes
is tested by itself; so are errors at a few moments of a run, at one frequency, and waves over a
displacement.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from tsas_cli.diagnosis.tolerances import LONGEST_MM, TRAVEL_MM
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats, Indices
from tsas_cli.support.wording import listed

Errors = Mapping[str, Floats]  # of one run, by channel

FEWEST_STROKES = 4
LATE = 2.0  # mean delay of the strokes of a complete model at most, in units of `delays`
FAR, FARTHEST = 4.0, 10.0  # standard deviations, and where one error counts for no more
START_S = 1.0  # of a run, in which a load still moves that was moved just before
FEWEST_FAR = 8  # errors that far: fewer may be a reversal out of place
UPPER_QUARTILE = 0.67449  # of the normal distribution, in standard deviations
BRIEF = 0.15  # mean square of the errors that far, over the variance, of a run with brief errors
ABOVE_NOISE = 0.15  # of its square: the mean square of such a run is larger by that
LATE_CRITICAL = 4.0  # critical value of the t statistic of that mean
PEAK = 0.3  # share of a run's squares in one narrow band from which the residual is periodic
RIPPLE = 0.1  # share of a channel's squares in a wave over a displacement that is none of noise,
SHARP, ASIDE = 3.0, 1.3  # so many times that of any wave whose period differs by that factor
CYCLES = 5.0, 60.0, 0.2  # of such a wave within the longest stroke: from, to, step
MOST = 1000  # errors of a run that are taken for it
SAME = 0.1  # relative difference of frequencies that are the same
TINY_MM = 1e-9
OWN = 2.5  # multiple of the motion's frequency from which an oscillation is not its own


def at_moments(
    bench: Bench, errors: Sequence[RunErrors], rigs: Sequence[Rig]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the channels whose strokes lag or lead, and those with errors at a few moments."""
    pairs = list(zip(errors, rigs, strict=True))
    delays, parts = [run.delays(rig) for run, rig in pairs], [run.errors(rig) for run, rig in pairs]
    late, brief = [], []
    for name in bench.channels:
        seen = [
            of_run[name] * (np.abs(of_run[name]) * run.delay_unit > _unseen(run, name))
            for (run, _), of_run in zip(pairs, delays, strict=True)
            if name in of_run
        ]
        if _is_late(np.concatenate(seen)):
            late.append(name)
        if any(
            _deviates_briefly(run, name, part[name])
            for (run, _), part in zip(pairs, parts, strict=True)
            if name in part
        ):
            brief.append(name)
    return tuple(late), tuple(brief)


def _unseen(run: RunErrors, name: str) -> float:
    """Return by how much x_out may be off unseen [mm]: a contact's travel, a count of x_in."""
    drive = run.run.drive_column
    if not name.endswith("_mm") or not drive.endswith("_mm"):
        return 0.0
    return max(LONGEST_MM, run.run.conditioned[drive].step)


def _deviates_briefly(run: RunErrors, name: str, errors: Floats) -> bool:
    """Return whether a channel deviates at a few moments of a run, but for those of its start."""
    since = run.run.time_s[run.samples[name]] > run.run.time_s[0] + START_S
    return bool(since.any()) and _is_brief(errors[since], _unseen_in(run, name)[since])


def _unseen_in(run: RunErrors, name: str) -> Floats:
    """Return up to which error each sample of a channel may be off unseen, over its weight.

    A force changes with a contact's travel as it does with the noise of the drive, and at most as
    it does within a window of the drive's cleaning.
    """
    from scipy.ndimage import maximum_filter1d

    at = run.samples[name]
    weight = run.weights[name][at]
    if name.endswith("_mm") or not run.run.drive_column.endswith("_mm"):
        return np.asarray(_unseen(run, name) / weight)
    drive = run.run.conditioned[run.run.drive_column]
    of_drive = np.sqrt(np.maximum(weight**2 - run.run.noise[name] ** 2, 0.0))
    moved = np.maximum(drive.sd[at], TINY_MM)
    stiffness = of_drive / moved
    step_s = float(np.median(np.diff(run.run.time_s[at])))
    near = maximum_filter1d(stiffness, 1 + 2 * round(drive.window_s / step_s))
    return np.asarray(near * max(TRAVEL_MM, drive.step) / weight)


def _is_brief(errors: Floats, least: Floats | float = 0.0) -> bool:
    """Return whether what a run's errors exceed the noise by comes at a few moments.

    Noise is as large at any time, and seldom far beyond its own standard deviation, or that which
    the weights of the errors say. Errors up to `least` count for none: every contact gives way by
    so much before it slides.
    """
    own = float(np.median(np.abs(errors - np.median(errors)))) / UPPER_QUARTILE
    if own == 0.0:  # most errors are the same, as of a coarse channel
        return False
    sd = max(own, 1.0)
    size = np.minimum(np.abs(errors) / sd, FARTHEST)
    beyond = np.where((size > FAR) & (np.abs(errors) > least), size, 0.0) ** 2
    brief = np.count_nonzero(beyond) >= FEWEST_FAR and float(np.mean(beyond)) > BRIEF
    return bool(brief) and float(np.mean(errors**2)) > 1.0 + ABOVE_NOISE


def _is_late(delays: Floats) -> bool:
    """Return whether strokes with these delays lag behind the model, or lead it, on average."""
    if delays.size < FEWEST_STROKES:
        return False
    scatter = float(delays.std(ddof=1)) / math.sqrt(delays.size)
    return abs(float(delays.mean())) > max(LATE, LATE_CRITICAL * scatter)


def oscillation(runs: Sequence[RunErrors], errors: Sequence[Errors]) -> str | None:
    """Return a phrase on a dominant frequency of the residuals of half of the runs, or None.

    `errors` are the weighted residuals of each run. The frequency is the same in all of them; one
    that is a multiple of each run's strokes is the motion's.
    """
    found, multiples = [], []
    for run, of_run in zip(runs, errors, strict=True):
        strokes = run.run.conditioned[run.run.drive_column].reversals.size - 1
        for name, own in of_run.items():
            time_s = run.run.time_s[run.samples[name]]
            even = np.linspace(time_s[0], time_s[-1], own.size)
            power = np.abs(np.fft.rfft(np.interp(even, time_s, own - own.mean()))) ** 2
            peak = int(np.argmax(power))
            band = power[max(peak - 1, 0) : peak + 2].sum() / power.sum()
            if band > PEAK and peak > OWN * 0.5 * strokes:
                found.append((name, peak / (even[-1] - even[0])))
                multiples.append(peak / strokes)
    if not found:
        return None
    frequencies = [frequency for _, frequency in found]
    if _spread(multiples) + SAME / 10.0 < 0.5 * _spread(frequencies):
        return None
    frequency = float(np.median(frequencies))
    alike = [name for name, f in found if abs(f - frequency) <= SAME * frequency]
    if len(alike) < max(2, len(runs) // 2):
        return None
    names = sorted(set(alike))
    verb = "oscillates" if len(names) == 1 else "oscillate"
    return f"time_s ({listed(names)} {verb} at {frequency:.3g} Hz)"


def ripple(runs: Sequence[RunErrors], errors: Sequence[Errors]) -> str | None:
    """Return a phrase on a period of displacement with which a residual repeats, or None.

    `errors` are the weighted residuals of each run. Such periods are shorter than what hat
    functions follow: the divisions of an encoder, the teeth of a gear. The phase of each run is its
    own.
    """
    best, phrase = RIPPLE, None
    for name in sorted({name for of_run in errors for name in of_run}):
        parts = [
            (run, of_run[name]) for run, of_run in zip(runs, errors, strict=True) if name in of_run
        ]
        if float(np.mean(np.concatenate([e**2 for _, e in parts]))) < 1.0 + ABOVE_NOISE:
            continue
        for column in ("x_in_mm", "x_out_mm"):
            found = _repeating(
                [(run.run.channel(column), run.samples[name], e) for run, e in parts]
            )
            if found is not None and found[0] > best:
                best, phrase = found[0], f"{column} ({name} repeats every {found[1]:.3g} mm)"
    return phrase


def _repeating(
    parts: Sequence[tuple[Floats | None, Indices, Floats]],
) -> tuple[float, float] | None:
    """Return the largest share of the squares in one wave over the displacement, and its period.

    Of each run are given the displacement at all samples, the samples, and the errors there. None
    where it is not recorded, or waves of other periods have as much.
    """
    known = [
        (place[at][:: -(-at.size // MOST)], error[:: -(-at.size // MOST)])
        for place, at, error in parts
        if place is not None
    ]
    known = [(place, e) for place, e in known if np.isfinite(place).all()]
    longest = max((float(np.ptp(place)) for place, _ in known), default=0.0)
    if longest == 0.0:
        return None
    per_mm = np.arange(*CYCLES) / longest
    squares = sum(float(e @ e) for _, e in known)
    share = (
        sum(
            2.0 * np.abs(e @ np.exp(2j * np.pi * np.outer(place, per_mm))) ** 2 / e.size
            for place, e in known
        )
        / squares
    )
    at = int(np.argmax(share))
    apart = np.abs(np.log(per_mm / per_mm[at])) > np.log(ASIDE)
    if share[at] < SHARP * share[apart].max():
        return None
    return float(share[at]), float(1.0 / per_mm[at])


def _spread(values: Sequence[float]) -> float:
    """Return the standard deviation of the logarithms of some values."""
    return float(np.std(np.log(values)))
