"""Which effects are proven, and what gives way to what; the fits are made up."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.test_proof import estimate
from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.constancy import Split
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.intervals import estimates_with_tolerances
from tsas_cli.diagnosis.proof import FoundCause, may_be_zero
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.steps import NO_PROGRESS


@dataclass(frozen=True)
class Search:
    """The effects of a search, with their rivals."""

    named: frozenset[str]
    rivals: dict[str, tuple[str, ...]]


ZERO = Estimate("backlash.play_mm", 0.01, "mm", "fitted", None, 0.01, 0.0, 0.03, False)
CLEAR_PLAY = replace(ZERO, value=0.1, interval_low=0.08, interval_high=0.12)


@pytest.mark.parametrize(
    ("negligible", "convincing", "complete", "play", "stand_ins"),
    [
        (True, True, False, CLEAR_PLAY, []),
        (False, True, False, CLEAR_PLAY, ["backlash"]),
        (False, True, False, ZERO, ["backlash"]),
        (False, False, False, CLEAR_PLAY, ["backlash"]),
        (False, True, True, CLEAR_PLAY, ["backlash"]),
        (False, True, True, ZERO, []),  # nothing is left without it
        (False, False, True, CLEAR_PLAY, []),
    ],
)
def test_an_effect_that_is_negligible_stands_in_for_nothing(
    monkeypatch, negligible, convincing, complete, play, stand_ins
):
    """It is left out all the same, and the others are judged without it."""
    fails = FoundCause(
        *("backlash", (), (play,), 1.0, (0.0, 2.0), ("fails",)),
        convincing=convincing,
        negligible=negligible,
    )
    holds = FoundCause("preload_loss", (), (), 9.0, (8.0, 10.0))

    def judged(search, fits, found):
        causes = [cause for cause in (fails, holds) if cause.effect in search.named]
        after = SimpleNamespace(complete=complete)
        return p.Proven(search, fits, tuple(causes), found, (), {}, after, after, None)

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    names = ("backlash", "preload_loss")
    found = p.proven_effects(Search(frozenset(names), dict.fromkeys(names, ())), NO_PROGRESS)
    assert [cause.effect for cause in found.causes] == ["preload_loss"]
    assert [cause.effect for cause in found.stand_ins] == stand_ins


@pytest.mark.parametrize(
    ("proven", "law", "complete", "named", "rivals"),
    [
        ({"load_ripple"}, "", True, "load_ripple", ("free_tendon", "friction_drift")),
        ({"free_tendon"}, "", True, "free_tendon", ("load_ripple", "friction_drift")),
        ({"friction_drift"}, "", True, None, ()),  # fits worse than the first two
        ({"load_ripple"}, "", False, None, ()),  # more than noise is left
        ({"load_ripple"}, "over the speed", True, None, ()),
    ],
)
def test_an_effect_that_fails_gives_way_to_a_rival_that_is_proven(
    monkeypatch, proven, law, complete, named, rivals
):
    def judged(search, fits, found):
        causes = [
            FoundCause(
                *(name, search.rivals[name], (CLEAR_PLAY,), 9.0, (8.0, 10.0)),
                failed=() if name in proven | {"preload_loss"} else ("fails",),
                law_differs=law if name in proven else "",
            )
            for name in search.rivals
        ]
        after = SimpleNamespace(complete=complete)
        return p.Proven(search, fits, tuple(causes), found, (), {}, after, after, None)

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    others = ("load_ripple", "free_tendon", "friction_drift")
    search = Search(
        frozenset(("backlash", "preload_loss")), {"backlash": others, "preload_loss": ()}
    )
    found = p.proven_effects(search, NO_PROGRESS)
    of = {cause.effect: cause.rivals for cause in found.causes}
    assert of == {"preload_loss": ()} | ({named: rivals} if named else {})
    assert [cause.effect for cause in found.stand_ins] == ([] if named else ["backlash"])


@pytest.mark.parametrize(
    ("first", "second", "law", "refused"),
    [
        ("load_spring_nonlinearity", "load_ripple", "over the tension", True),
        ("load_spring_nonlinearity", "load_ripple", "", False),
        ("load_spring_nonlinearity", "drive_ripple", "over the tension", False),
        ("stribeck_friction", "sheath_compression", "over the speed", False),
        ("force_sensor_curvature", "force_sensor_tilt", "over the tension", True),
        ("force_sensor_curvature", "position_sensor_ripple", "over the tension", False),
    ],
)
def test_what_a_law_of_one_place_lacks_is_no_second_cause(first, second, law, refused):
    """Of two at one place the one that gains less is refused, where the other's law differs."""
    more = FoundCause(first, (), (), 60.0, (50.0, 70.0), law_differs=law)
    less = FoundCause(second, (), (), 40.0, (30.0, 50.0), law_differs=law)
    both = more, less
    assert p._beside_another_law(more, both) == more
    failed = p._beside_another_law(less, both).failed
    assert bool(failed) == refused
    assert not failed or "nonlinear load spring" in failed[0] or "curved scale" in failed[0]


@pytest.mark.parametrize(
    ("first", "last", "reducible", "structure", "refused"),
    [
        (401.0, 40.0, 39.0, 1.0, False),  # a tenth of 400, less a little
        (401.0, 42.0, 41.0, 1.0, True),
        (401.0, 1.0, 0.0, 1.0, False),
        (401.0, 42.0, 41.0, 0.0, False),
    ],
)
def test_where_much_is_left_no_effect_is_proven(first, last, reducible, structure, refused):
    """A lost motion at the drive passes for a gain of x_out that takes half of it."""
    start = Remainder(first, {"x_out_mm": 1.0}, ())
    after = Remainder(last, {"x_out_mm": structure}, (), reducible=reducible)
    cause = FoundCause("position_sensor_gain", (), (), 50.0, (40.0, 60.0))
    failed = p._beside_what_is_left(cause, start, after, 0.004).failed
    assert failed == (("leaves 10 % of what could be explained",) if refused else ())


@pytest.mark.parametrize(
    ("late_s", "complete", "refused"),
    [
        ((-0.0010, -0.0015), False, True),
        ((-0.0010, -0.0025), False, False),
        ((-0.0010, -0.0015), True, False),
    ],
)
def test_a_delay_within_half_a_sample_interval_is_no_cause_where_more_is_wrong(
    late_s, complete, refused
):
    names = ("f_in", "x_out")
    delays = tuple(
        Estimate(f"channel_delay.{name}_delay_s", late, "s", "fitted")
        for name, late in zip(names, late_s, strict=True)
    )
    cause = FoundCause("channel_delay", (), delays, 12.0, (8.0, 18.0))
    start, after = Remainder(9.0, {}, ()), Remainder(1.0, {"f_in_N": 0.0 if complete else 0.2}, ())
    assert bool(p._beside_what_is_left(cause, start, after, 0.004).failed) == refused


@pytest.mark.parametrize(("values", "within"), [((0.09, 0.11), True), ((0.09, 0.13), False)])
def test_parts_within_the_interval_of_the_whole_do_not_differ(values, within):
    parts = tuple(zip(("low", "high"), values, strict=True))
    split = Split("backlash.play_mm", "speed", Reduction(0.1, 3.0), parts)
    assert p._within_interval(split, [CLEAR_PLAY]) == within


@pytest.mark.parametrize(
    ("period_mm", "gains", "refused"),
    [
        (2.345, 10.0, True),
        (1.6, 10.0, True),
        (3.4, 10.0, False),
        (4.8, 10.0, False),
        (2.1, 10.0, False),
        (2.345, 40.0, False),
    ],
)
def test_a_wave_of_half_the_period_of_a_larger_one_is_no_cause(period_mm, gains, refused):
    """A gear whose ripple has a harmonic passes for a position sensor off its centre."""

    def wave(effect, period, gain):
        periods = (estimate(f"{effect}.period_mm", period, period - 0.1, period + 0.1, unit="mm"),)
        return FoundCause(effect, (), periods, gain, (gain - 2.0, gain + 2.0))

    drive = wave("drive_ripple", 4.82, 30.0)
    cause = wave("position_sensor_ripple", period_mm, gains)
    plain = FoundCause("backlash", (), (), 50.0, (40.0, 60.0))
    failed = p._beside_a_wave(cause, (drive, cause, plain)).failed
    assert failed == (
        ("may be a harmonic of ripple of the drive's gear, or of its encoder",) * refused
    )


def sensor_error(effect, **values):
    """Return an error of sensors, by parameter whether it differs from none."""
    return FoundCause(
        *(effect, ()),
        tuple(
            estimate(f"{effect}.{name}", v, *sorted((0.9 * v, 1.1 * v)), unit="1")
            if v
            else estimate(f"{effect}.{name}", 0.0, -0.1, 0.1, unit="1")
            for name, v in values.items()
        ),
        *(40.0, (30.0, 50.0)),
    )


@pytest.mark.parametrize(("third", "refused"), [("f_out", True), ("f_in", False)])
def test_three_errors_of_one_sensor_may_be_one_law_of_it(third, refused):
    """A force sensor that creeps passes for one with a gain, hysteresis and a low pass."""
    gain = sensor_error("force_sensor_gain", f_out_gain=1.2)
    hysteresis = sensor_error("force_sensor_hysteresis", f_in_share=0.0, f_out_share=0.1)
    lag = sensor_error("sensor_lag", **{f"{third}_lag_s": 0.02})
    plain = FoundCause("backlash", (), (CLEAR_PLAY,), 50.0, (40.0, 60.0))
    for cause in (gain, hysteresis, lag, plain):
        failed = p._beside_others_of_its_sensor(cause, (gain, hysteresis, lag, plain)).failed
        of_it = refused and cause is not plain
        assert failed == (
            ("is one of 3 errors of the f_out sensor, which may be one law of it",) * of_it
        )


@pytest.mark.parametrize(
    ("delay_s", "lag_s", "refused"),
    [(-0.031, 0.030, True), (0.031, 0.030, False), (-0.005, 0.030, False), (-0.031, 0.0, False)],
)
def test_a_channel_that_leads_by_as_much_as_it_lags_does_neither(delay_s, lag_s, refused):
    delay = sensor_error("channel_delay", f_in_delay_s=delay_s, x_out_delay_s=0.0)
    lag = sensor_error("sensor_lag", f_in_lag_s=lag_s, x_out_lag_s=0.0)
    for cause in (delay, lag):
        assert bool(p._beside_its_opposite(cause, (delay, lag)).failed) == refused
    gain = sensor_error("force_sensor_gain", f_out_gain=1.2)
    assert p._beside_its_opposite(gain, (delay, lag, gain)) == gain


def test_an_effects_shape_is_held_where_it_may_be_zero():
    """Three runs tell the size well at each shape, and hardly its time: they scatter along both."""
    rng, rows = np.random.default_rng(4), 60
    wave, other = np.linalg.qr(rng.standard_normal((rows, 2)))[0].T
    jacobian = np.tile(np.column_stack((30.0 * wave, 3.0 * wave + 3.0 * other)), (3, 1))
    noise = 0.1 * rng.standard_normal(3 * rows)
    residual = noise + np.concatenate([error * other for error in (4.0, -4.0, 0.5)])
    names = ("load_relaxation.share", "load_relaxation.time_s")
    values = np.array(
        [QUANTITIES[name].scaled(value) for name, value in zip(names, (0.02, 2.0), strict=True)]
    )
    unknowns = tuple(unknown_of(name) for name in names)
    solution = Solution(values, np.zeros(2, bool), residual, jacobian, True, "", 1)
    trial = HypothesisFit(("load_relaxation",), unknowns, solution, (rows,) * 3, on_mesh=True)
    block = np.repeat(np.arange(18), 10)
    run = np.repeat(np.arange(3), rows)
    bench = SimpleNamespace(
        rigs=[None] * 3, base=SimpleNamespace(problem=SimpleNamespace(ids=["a", "b", "c"]))
    )
    judged = SimpleNamespace(
        bench=bench,
        folds=Folds(run, block, run, by_run=True),
        named=frozenset({"load_relaxation"}),
        trial=lambda _: trial,
    )
    tolerated = np.zeros((3 * rows, 7))
    found = estimates_with_tolerances(judged, trial, tolerated)
    assert may_be_zero("load_relaxation", found.moved, found.correlation)
    last = SimpleNamespace(judged=judged, found=found, tolerated=tolerated)
    assert not p._may_be_zero(last, "load_relaxation")
