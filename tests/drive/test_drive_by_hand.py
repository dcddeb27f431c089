"""The diagnosis of a drive, decision by decision, on squares that are made up; and its words."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.diagnose import (
    _as_sure_as_the_data_sheet,
    _two_digits,
    leaves_much,
    verdict_of,
)
from tsas_cli.diagnosis.evidence import gain
from tsas_cli.drive import diagnosis as dd
from tsas_cli.drive import search as ds
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.harmonic_drive import DriveValues, linear_response
from tsas_cli.drive.runs import DriveRun
from tsas_cli.drive.search import NOTHING, drive_folds
from tsas_cli.drive.words import (
    cannot_tell,
    equation_of,
    inverse_of,
    name_of,
    next_run,
)
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Unknown
from tsas_cli.numerics.linear_response import sampled
from tsas_cli.records.base import Fit
from tsas_cli.records.drive import Drive, Pole, Response

BLOCKS = 20


def terms(*names):
    return frozenset(names)


class MadeUp:
    """A search whose held-out squares per block are given by set of terms; it is its own fits."""

    def __init__(self, squares, default=10.0):
        self.given, self.default, self.fitted = squares, default, []
        self.fits = self

    def held_out(self, names):
        return np.full(BLOCKS, float(self.given.get(names, self.default)))

    def mean_square(self, names):
        return self.given.get(names, self.default)

    def trial(self, names):
        self.fitted.append(names)
        return SimpleNamespace(solution=SimpleNamespace(converged=True), mean_square=0.0)

    def trials_of(self, sets):
        return [self.trial(names) for names in sets]

    def gain(self, before, after):
        return gain(self.held_out(before), self.held_out(after))


ALL = [terms(), terms("lag"), terms("delay"), terms("spring"), terms("lag", "spring")]


def test_rivals_of_a_lag_are_what_explains_as_much_in_its_place():
    search = MadeUp({NOTHING: 5.0, terms("lag"): 1.0, terms("delay"): 1.005, terms("play"): 1.02})
    assert ds.rivals(search, terms("lag"), "lag") == ("delay",)
    closer = MadeUp({NOTHING: 5.0, terms("lag"): 1.0, terms("play"): 1.005})
    assert ds.rivals(closer, terms("lag"), "lag") == ("play",)
    alone = MadeUp({NOTHING: 1.01, terms("lag"): 1.0, terms("delay"): 1.0})
    assert ds.rivals(alone, terms("lag"), "lag") == ()  # no better than nothing


def test_the_gear_is_looked_at_where_something_is_left():
    quiet = MadeUp({NOTHING: 1.14}, default=0.5)
    assert ds._with_gear(quiet, NOTHING) == NOTHING
    assert quiet.fitted == []
    play = MadeUp({NOTHING: 4.0, terms("play"): 1.0, terms("ripple", "play"): 1.0}, default=4.0)
    assert ds._with_gear(play, NOTHING) == terms("play")
    ripple = MadeUp({NOTHING: 4.0, terms("ripple"): 1.0, terms("ripple", "play"): 0.98}, 4.0)
    assert ds._with_gear(ripple, NOTHING) == terms("ripple")  # both are not surely better
    both = MadeUp({NOTHING: 4.0, terms("ripple"): 2.0, terms("ripple", "play"): 1.0}, 4.0)
    assert ds._with_gear(both, NOTHING) == terms("ripple", "play")
    neither = MadeUp({NOTHING: 4.0}, default=3.99)
    assert ds._with_gear(neither, NOTHING) == NOTHING
    found = MadeUp({terms("ripple", "play"): 4.0}, default=1.0)
    assert ds._with_gear(found, terms("ripple", "play")) == terms("ripple", "play")


def test_a_gear_that_lags_explain_as_well_is_left_out(monkeypatch):
    search = MadeUp({terms("lag", "play"): 1.0, terms("lag"): 1.01})
    monkeypatch.setattr(ds, "chosen", lambda search, gear: terms("lag") | gear)
    assert ds._without_idle_gear(search, terms("lag", "play")) == terms("lag")
    needed = MadeUp({terms("lag", "play"): 1.0, terms("lag"): 3.0})
    assert ds._without_idle_gear(needed, terms("lag", "play")) == terms("lag", "play")


def run_of(kind, size=1000, highest_Hz=20.0):
    t = 0.005 * np.arange(size)
    rate = highest_Hz / t[-1]
    speed = 500.0 * np.sin(2.0 * np.pi * 0.5 * rate * t**2)
    u = sampled(0.005, speed, "first")
    return DriveRun(kind, u, linear_response(u, DriveValues(0.02)), 1e-3, at_rest=True)


def test_runs_of_one_band_are_held_out_one_by_one():
    runs = [run_of("a"), run_of("b", 1200)]
    residuals = [np.random.default_rng(k).standard_normal(r.x_in.size) for k, r in enumerate(runs)]
    folds = drive_folds(runs, residuals)
    assert folds.by_run
    np.testing.assert_array_equal(folds.fold, np.repeat([0, 1], [1000, 1200]))
    assert np.all(np.diff(folds.block) >= 0)
    assert folds.block[999] < folds.block[1000]
    assert 100 <= folds.blocks <= 220


@pytest.mark.parametrize("others", [[], [run_of("slow", 1000, 5.0)]])
def test_what_only_one_run_shows_is_held_out_in_stretches(others):
    runs = [run_of("a"), *others]
    residuals = [np.random.default_rng(k).standard_normal(r.x_in.size) for k, r in enumerate(runs)]
    folds = drive_folds(runs, residuals)
    assert not folds.by_run
    np.testing.assert_array_equal(folds.fold, folds.block % 4)


def searched(residual, *, noises=(1.0, 2.0)):
    """Two runs of half of the residual each, in blocks of ten samples, held out in turns."""
    size = residual.size // 2
    u = sampled(0.01, 300.0 * np.sin(0.05 * np.arange(size)), "first")
    runs = [
        SimpleNamespace(
            noise_mm=noise,
            x_in=0.02 * u.integral,
            u=u,
            time_s=0.01 * np.arange(size),
            counts=np.ones(size, dtype=bool),
        )
        for noise in noises
    ]
    block = np.arange(residual.size) // 10
    folds = SimpleNamespace(
        block=block, run=np.repeat([0, 1], size), fold=block % 4, blocks=int(block.max()) + 1
    )
    trial = SimpleNamespace(solution=SimpleNamespace(residual=residual))
    squares = np.bincount(block, residual**2)
    return SimpleNamespace(
        bench=SimpleNamespace(runs=runs),
        folds=folds,
        held_out=lambda _: squares,
        trial=lambda _: trial,
    )


def test_errors_and_noise_are_in_millimetres_of_each_run():
    """Residuals are in units of each run's noise: 1 and 2 mm here."""
    search = searched(np.full(400, 3.0))
    assert dd._rmse(search, NOTHING) == pytest.approx(3.0 * math.sqrt(0.5 * (1.0 + 4.0)))
    assert dd._noise(search) == pytest.approx(math.sqrt(0.5 * (1.0 + 4.0)))
    assert dd._noises(search).tolist() == [1.0] * 20 + [2.0] * 20


def test_what_is_left_depends_on_what_it_was_made_of():
    """A wave over the motor's angle, with period one turn of it."""
    plain = searched(np.zeros(2000))
    angle = np.concatenate([r.u.integral * math.pi / 30.0 for r in plain.bench.runs])
    noise = np.random.default_rng(1).standard_normal(2000)
    depends, part = dd._left(searched(8.0 * np.sin(angle) + noise), NOTHING)
    assert depends[0] == "motor_angle_rad"
    assert 0.8 < part < 1.0
    none, nothing = dd._left(searched(noise), NOTHING)
    assert none == ()
    assert nothing == 0.0


@pytest.mark.parametrize(
    ("rivals", "left", "share", "verdict"),
    [
        ([], 1.29, 1.0, "sufficient"),  # 1 + 2 · 0.15
        ([], 1.31, 1.0, "unexplained"),
        ([()], 1.0, 0.51, "unexplained"),
        ([()], 1.0, 0.5, "named"),
        ([()], 9.0, 0.49, "named"),
        ([(), ("play",)], 1.0, 0.0, "ambiguous"),
    ],
)
def test_the_verdict_on_what_is_left(rivals, left, share, verdict):
    assert verdict_of(rivals, left, share) == verdict


@pytest.mark.parametrize(
    ("left", "share", "much"),
    [
        (4.1, 0.0, True),
        (4.0, 0.0, False),
        (2.0, 0.02, False),
        (3.9, 0.019, False),
        (3.9, 0.021, True),
        (1.16, 0.021, True),
        (1.14, 0.9, False),
    ],
)
def test_what_nobody_calls_explained(left, share, much):
    assert leaves_much(left, share) == much


def test_two_digits_and_no_more():
    told = [_two_digits(v) for v in (1.0, 1.04, 9.94, 9.96, 10.4, 123.0)]
    assert told == ["1.0", "1.0", "9.9", "10", "10", "120"]


def test_a_sheath_is_as_unsure_as_the_tendons_data_sheet():
    """(1 + ratio)/EA is what is told: with EA 20 % up or down the ratio follows."""
    unknown = Unknown("tendon_stiffness_N", None, 0.0, math.log(0.8), math.log(1.2), 1.0)
    trial = SimpleNamespace(unknowns=[unknown], solution=SimpleNamespace(values=np.zeros(1)))
    ratio = Estimate("sheath_compression.compliance_ratio", 0.5, "1", "fitted", None, 0.0, 0.5, 0.5)
    found = _as_sure_as_the_data_sheet(ratio, trial)
    assert found.interval_low == pytest.approx(1.5 * 0.8 - 1.0)
    assert found.interval_high == pytest.approx(1.5 * 1.2 - 1.0)
    assert found.stderr == pytest.approx(0.3 / 1.96)
    low = _as_sure_as_the_data_sheet(Estimate("r", 0.1, "1", "fitted"), trial)
    assert low.interval_low == 0.0
    without = SimpleNamespace(unknowns=[], solution=trial.solution)
    assert _as_sure_as_the_data_sheet(ratio, without) is ratio


def test_structures_in_words():
    assert name_of(NOTHING) == "integrator"
    assert name_of(terms("leak")) == "1/(s + a)"
    assert name_of(terms("delay", "spring")) == "integrator with second-order lag and delay"
    assert equation_of(NOTHING) == "G(s) = K / s"
    assert equation_of(terms("lag", "delay")) == "G(s) = K e^(−Ts) / (s (τs + 1))"
    whole = equation_of(terms("leak", "lag", "spring"))
    assert whole == "G(s) = K / ((s + a) (τs + 1) (s²/ω² + 2ζs/ω + 1))"


def test_the_inverse_in_words():
    assert inverse_of(DriveValues(0.02)).startswith("G⁻¹(s) ≈ 50 s; u_ff")
    slow = DriveValues(0.02, motor_lag_s=0.1, leak_per_s=0.3)
    assert inverse_of(slow).startswith("G⁻¹(s) ≈ 51.5 s + 5 s² + 15; u_ff")


def found(rivals=(), unexplained=False):
    return SimpleNamespace(causes=[SimpleNamespace(rivals=rivals)], unexplained=unexplained)


def test_what_to_record_next():
    assert "higher frequencies" in next_run(found(("play",), True))
    assert "Repeat a run" in next_run(found((), True))
    assert "half the amplitude" in next_run(found())


def drive(band=(0.5, 12.0), poles=(), converged=True):
    """Return of the record what says what cannot be told."""
    return Drive.model_construct(
        frequency_response=Response.model_construct(band_Hz=band),
        poles=tuple(poles),
        fit=Fit(converged=converged, message="too many steps"),
    )


NO_SHEET = DataSheet(None, None, None, None)
SHEET = DataSheet(27.1, 120.0, 0.13, 2.3)


def test_what_cannot_be_told_of_a_drive():
    lag = {"kind": "lag", "real_per_s": -1.0, "imaginary_per_s": 0.0}
    far = Pole(**lag, frequency_Hz=23.0, in_band=False)
    near = Pole(**lag, frequency_Hz=3.0, in_band=True)
    quiet = cannot_tell(drive(poles=[near]), SHEET, terms("spring"), ())
    assert quiet == []
    (outside,) = cannot_tell(drive(poles=[near, far]), SHEET, terms("spring"), ())
    assert outside.startswith(
        "A lag lies at 23 Hz, outside of the band that the input shows (0.5 to"
    )
    stiff = cannot_tell(drive(), SHEET, NOTHING, ())
    assert stiff == [
        "These recordings show no resonance: the drive is stiffer than they tell, beyond 12 Hz."
    ]
    dark = cannot_tell(drive(None, [far]), SHEET, NOTHING, ())
    assert "coherence above 0.8" in dark[0]
    assert dark[1].endswith("stiffer than they tell.")
    assert len(dark) == 2
    ratios, reaction = cannot_tell(drive(), NO_SHEET, terms("spring"), ())
    assert ratios.startswith("Speed and position show ratios")
    assert "pull-back k_p" in reaction
    bound = {
        "play_mm": Estimate("play_mm", 0.0, "mm", "fitted", at_bound=True),
        "delay_s": Estimate("delay_s", 0.1, "s", "fitted"),
    }
    assert cannot_tell(drive(), SHEET, terms("spring"), bound.values()) == [
        "play_mm ended at its bound."
    ]
    (said,) = cannot_tell(drive(converged=False), SHEET, terms("spring"), ())
    assert said == "The fit did not converge: too many steps."
