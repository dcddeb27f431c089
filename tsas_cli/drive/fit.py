"""Drives fitted to recordings: each set of terms by output error, every one in the same way.

The residual is simulated less measured x_in in units of its noise. The place where each run begins,
and its free motion where it does not begin at rest, enter linearly and are taken out of it.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tsas_cli.drive.harmonic_drive import (
    DriveValues,
    free_motion,
    gear_response,
    has_gear,
    lag_coefficients,
    linear_response,
)
from tsas_cli.drive.runs import DriveRun, FrequencyResponse
from tsas_cli.effects.backlash import BACKLASH
from tsas_cli.effects.drive_ripple import DRIVE_RIPPLE
from tsas_cli.identification.extension import MOST_LOOSENING
from tsas_cli.identification.fit import Unknown, solve
from tsas_cli.identification.quantities import Quantity
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.arrays import Complex, Floats

Terms = frozenset[str]

TOLERANCE = 1e-6  # of the squares, for the last step
LOG_SCALE = 0.5  # plausible relative change of a positive number
SMALL_MM = 0.01
SETTLED = 3  # times that the position where a run began is found again, with its ripple
FOLLOWED = 3  # of the initial values, the best ones
WEIGHT = 0.05  # relative error of one point of the measured response, for initial values


def _positive(name: str, unit: str, initial: float, lower: float, upper: float) -> Quantity:
    return Quantity(name, unit, lower, upper, initial, positive=True)


RIPPLE, PLAY = DRIVE_RIPPLE.parameters, BACKLASH.parameters[0]
GAIN = _positive("gain_mm_per_s_rpm", "mm/(s rpm)", 0.02, 1e-7, 1e3)
DAMPING = _positive("damping_ratio", "1", 0.1, 1e-3, 1.0)  # beyond 1 it is two lags
TERMS: dict[str, tuple[Quantity, ...]] = {
    "lag": (Quantity("motor_lag_s", "s", 0.0, 5.0, 0.005, size=0.01),),
    "delay": (Quantity("delay_s", "s", 0.0, 0.5, 0.005, size=0.01),),
    "spring": (_positive("natural_frequency_Hz", "Hz", 50.0, 0.05, 2e3), DAMPING),
    "leak": (Quantity("leak_per_s", "1/s", 0.0, 10.0, 0.0, size=1e-3),),
    "ripple": tuple(
        Quantity(p.name, p.unit, p.lower, p.upper, 0.0, size=SMALL_MM) for p in RIPPLE[:2]
    ),
    "play": (Quantity(PLAY.name, PLAY.unit, 0.0, PLAY.upper, 0.0, size=0.1),),
    # The spring of Eq. (25): the data sheet's frequency, without reaction.
    "stated": (_positive("damping_ratio", "1", 0.5, 1e-3, 1e3),),
}
LINEAR = ("lag", "delay", "spring", "leak")
QUANTITIES = {q.name: q for q in (GAIN, *(q for t in TERMS if t != "stated" for q in TERMS[t]))}


@dataclass(frozen=True)
class DriveTrial:
    """One set of terms fitted."""

    terms: Terms
    unknowns: tuple[Unknown, ...]
    solution: Solution
    values: DriveValues

    @property
    def mean_square(self) -> float:
        """Mean square of the residuals, 1 where nothing but noise is left."""
        return float(np.mean(self.solution.residual**2))


@dataclass(frozen=True, eq=False)
class DriveBench:
    """Runs of a drive on which sets of terms are tried, and their measured frequency response.

    `stated_Hz` is Eq. (25)'s natural frequency, where the data sheet gives it.
    """

    runs: Sequence[DriveRun]
    seen: FrequencyResponse
    stated_Hz: float | None = None

    @cached_property
    def gain(self) -> float:
        """The initial value of the gain [mm/(s rpm)]: the travel per turn of all runs."""
        both = squares = 0.0
        for run in self.runs:
            turns = run.u.integral - run.u.integral.mean()
            both += float(turns @ (run.x_in - run.x_in.mean())) / run.noise_mm**2
            squares += float(turns @ turns) / run.noise_mm**2
        return max(both / squares, GAIN.lower)

    def fit(self, terms: Iterable[str], simpler: Iterable[DriveTrial] = ()) -> DriveTrial:
        """Fit a set of terms from several initial values and return the best fit.

        It begins with the measured response, and with what was found for simpler sets with what
        they lack at nothing and at a little, so that it cannot fit worse than they do.
        """
        terms = frozenset(terms)
        quantities = quantities_of(terms)
        fresh = self._from_response(terms)
        starts = []
        for known in (fresh, *(trial.values for trial in simpler)):
            lacking = [q for q in quantities if getattr(known, q.name) == 0.0]
            starts.append(known._replace(**{q.name: getattr(fresh, q.name) for q in lacking}))
            if lacking and not any(q.positive for q in lacking):
                starts += [
                    known._replace(**{q.name: size * q.size for q in lacking})
                    for size in (0.0, 0.1, 1.0)
                ]
        ranked = sorted(((self._mean_square(s), k) for k, s in enumerate(starts)))[:FOLLOWED]
        # Far from the noise a rougher fit shows as much.
        tolerance = TOLERANCE * min(max(ranked[0][0], 1.0), MOST_LOOSENING)
        found = [self._solved(quantities, starts[k], terms, tolerance) for _, k in ranked]
        return min(found, key=lambda trial: (not trial.solution.converged, trial.mean_square))

    def _mean_square(self, values: DriveValues) -> float:
        errors = [self._error(r, values) for r in range(len(self.runs))]
        return float(sum(e @ e for e in errors)) / sum(e.size for e in errors)

    def simulated(self, r: int, values: DriveValues) -> Floats:
        """Return x_in of a run [mm] as a drive moves it, begun where it fits best, shape (n,).

        NaN where the run's samples are copies of another run's.
        """
        run = self.runs[r]
        x_in = np.where(run.counts, run.x_in, np.nan)
        x_in[run.counts] += run.noise_mm * self._error(r, values)
        return x_in

    def _solved(
        self, quantities: Sequence[Quantity], start: DriveValues, terms: Terms, tolerance: float
    ) -> DriveTrial:
        unknowns = [_unknown(q, getattr(start, q.name)) for q in quantities]

        def residuals(r: int, scaled: Floats) -> Floats:
            return self._error(r, self._values(quantities, scaled, terms))

        solution = solve(unknowns, len(self.runs), residuals, tolerance=tolerance, at_once=False)
        values = self._values(quantities, solution.values, terms)
        return DriveTrial(terms, tuple(unknowns), solution, values)

    def _values(self, quantities: Sequence[Quantity], scaled: Floats, terms: Terms) -> DriveValues:
        known = {q.name: q.unscaled(v) for q, v in zip(quantities, scaled, strict=True)}
        if "stated" in terms and self.stated_Hz is not None:
            known["natural_frequency_Hz"] = self.stated_Hz
        return DriveValues(**known)

    def _error(self, r: int, values: DriveValues) -> Floats:
        """Return simulated less measured over noise, at the samples that count."""
        run = self.runs[r]
        error = linear_response(run.u, values) - run.x_in
        if has_gear(values):
            linear, start = error, -float(error[run.counts].mean())
            for _ in range(SETTLED if values.sine_mm or values.cosine_mm else 1):
                error = linear + gear_response(run.u, values, start)
                start = -float(error[run.counts].mean())
        error = error[run.counts] / run.noise_mm
        if run.at_rest:
            return np.asarray(error - error.mean())
        basis = np.column_stack((np.ones(run.x_in.size), free_motion(run.u, values)))
        basis = np.linalg.qr(basis[run.counts])[0]
        return np.asarray(error - basis @ (basis.T @ error))

    def _from_response(self, terms: Terms) -> DriveValues:
        """Return initial values: the terms fitted to the measured frequency response."""
        linear = [t for t in TERMS if t in terms and t not in ("ripple", "play")]
        quantities = quantities_of(linear)
        seen = self.seen
        jw = (2j * math.pi * seen.frequency_Hz[seen.excited]).astype(np.complex128)
        measured = seen.response[seen.excited]
        guesses = [_guess(linear, jw, measured, self.gain, part) for part in (1.0, 0.3)]
        if jw.size <= 2 * len(quantities):
            return guesses[0]

        def residuals(_: int, scaled: Floats) -> Floats:
            values = self._values(quantities, scaled, frozenset(linear))
            off = (response_at(values, jw) / measured - 1.0) / WEIGHT
            off /= 1.0 + 0.1 * np.abs(off)  # a few wrong points must not decide
            return np.concatenate((off.real, off.imag))

        best = guesses[0]
        least = math.inf
        for guess in guesses:
            unknowns = [_unknown(q, getattr(guess, q.name)) for q in quantities]
            found = solve(unknowns, 1, residuals, tolerance=1e-4, at_once=False)
            squares = float(found.residual @ found.residual)
            if squares < least:
                best, least = self._values(quantities, found.values, frozenset(linear)), squares
        return best


def quantities_of(terms: Iterable[str]) -> list[Quantity]:
    """Return the numbers of a set of terms, in their fixed order, the gain first."""
    chosen = set(terms)
    return [GAIN, *(q for name, term in TERMS.items() if name in chosen for q in term)]


def response_at(values: DriveValues, jw: Complex) -> Complex:
    """Return G(jω) of the linear part [mm per rpm s], shape (m,)."""
    lags = np.polynomial.polynomial.polyval(jw, lag_coefficients(values))
    late = np.exp(-jw * values.delay_s)
    return np.asarray(values.gain_mm_per_s_rpm * late / ((jw + values.leak_per_s) * lags))


def _unknown(q: Quantity, value: float) -> Unknown:
    scale = LOG_SCALE if q.positive else 1.0
    return Unknown(q.name, None, q.scaled(value), q.scaled(q.lower), q.scaled(q.upper), scale)


def _guess(
    terms: Sequence[str],
    jw: Complex,
    measured: Complex,
    gain: float,
    part: float,
) -> DriveValues:
    """Return values read off the measured response: its peak, and how late it is."""
    out = replace_defaults(terms, gain)
    if jw.size < 3:
        return out
    normal = measured * jw / gain
    w = jw.imag
    late = max(float(-np.median(np.angle(normal) / w)), 1e-4)
    share = part * late / max(len({"lag", "delay"} & set(terms)), 1)
    out = out._replace(
        motor_lag_s=share if "lag" in terms else 0.0, delay_s=share if "delay" in terms else 0.0
    )
    if "spring" in terms:
        peak = int(np.argmax(np.abs(normal)))
        height = float(np.abs(normal[peak]))
        clear = height > 1.2
        at = float(w[peak]) if clear else 2.0 / late
        out = out._replace(
            natural_frequency_Hz=at / (2.0 * math.pi),
            damping_ratio=0.5 / height if clear else 0.7,
        )
    return out


def replace_defaults(terms: Sequence[str], gain: float) -> DriveValues:
    """Return the usual initial value of each term."""
    known = {q.name: q.default for q in quantities_of(terms)}
    return DriveValues(**known)._replace(gain_mm_per_s_rpm=gain)
