"""From the terms of a drive to a verdict, its causes and its sentence."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.drive.verdicts import STATED, TITLE, TOLD, MadeUpSquares, cause, terms, verdict
from tsas_cli.drive import diagnosis as dd
from tsas_cli.drive.runs import DriveRun
from tsas_cli.drive.search import NOTHING
from tsas_cli.drive.sentences import EQUATION_NAME, STIFF_NAME
from tsas_cli.numerics.linear_response import sampled


class Searched(MadeUpSquares):
    """Held-out mean squares by set of terms, even over blocks of ten residuals."""

    def __init__(self, squares, *, stated=None, blocks=20, rivals=()):
        super().__init__(squares, math.nan, blocks=blocks, size=10)
        self.rivals = dict(rivals)
        self.bench = SimpleNamespace(stated_Hz=stated, runs=[SimpleNamespace(noise_mm=0.1)])
        block = np.arange(10 * blocks) // 10
        self.folds = SimpleNamespace(
            block=block, run=np.zeros(block.size, int), blocks=blocks, by_run=False
        )


@pytest.fixture
def diagnosed(monkeypatch):
    """What follows from a search; a share of 0.36 of the rest could be explained by time."""
    monkeypatch.setattr(dd, "_left", lambda search, terms: (("time_s",), 0.36))
    monkeypatch.setattr(dd, "rivals", lambda search, final, term: search.rivals.get(term, ()))
    return lambda search, final: dd.diagnose_drive(search, final, TOLD)[1]


def test_a_delay_is_named_with_its_gain_and_what_is_left(diagnosed):
    """Of 17 − 1 there is left 1.95 − 1 − 0.15: a twentieth."""
    search = Searched({NOTHING: 17.0, terms("delay"): 1.95})
    found = diagnosed(search, terms("delay"))
    assert (found.verdict, found.nominal) == ("named", STIFF_NAME)
    (cause,) = found.named
    assert (cause.effect, cause.kind, cause.rivals) == ("channel_delay", "pure delay", ())
    assert cause.title == "Pure delay of the motor"
    assert list(cause.parameters) == ["motor_lag_s", "delay_s"]
    assert cause.parameters["delay_s"].interval_high == 0.7
    percent = 100.0 * (1.0 - math.sqrt(1.95 / 17.0))
    assert cause.gain_percent == pytest.approx(percent)
    assert cause.gain_interval_percent == pytest.approx((percent, percent))
    assert found.gain_percent == pytest.approx(percent)
    assert found.gain_interval_percent == pytest.approx((percent, percent))
    assert found.remainder.share_percent == pytest.approx(80.0 / 16.0)
    assert found.remainder.mean_square == 1.95
    assert found.remainder.unexplained  # a twentieth is more than a fiftieth
    assert found.remainder.depends_on == ("time_s",)
    assert (found.evidence.held_out, found.evidence.blocks) == ("stretches", 20)
    assert found.evidence.sentence.startswith("Stretches are predicted by a fit to the rest; 20")
    search.folds.by_run = True
    runs = diagnosed(search, terms("delay")).evidence
    assert runs.held_out == "runs"
    assert runs.sentence.startswith("Each run is predicted by a fit to the others; 20 blocks")


def test_errors_of_the_drive_are_in_millimetres(diagnosed):
    def errors(left):
        search = Searched({NOTHING: 16.0, terms("delay"): left})
        return diagnosed(search, terms("delay")).channels["x_in_mm"]

    found = errors(4.0)
    assert (found.rmse_before, found.rmse_after) == pytest.approx((0.4, 0.2))
    assert found.noise_floor == pytest.approx(0.1)
    assert found.attainable == pytest.approx(0.2 * 0.8)  # √(1 − 0.36)
    low = errors(0.25)
    assert low.noise_floor == low.attainable == pytest.approx(0.05)
    assert errors(1.21).attainable == pytest.approx(0.1)


def test_without_a_cause_the_nominal_equation_stays(diagnosed):
    found = diagnosed(Searched({NOTHING: 1.0, terms("delay"): 0.99}), terms("delay"))
    assert (found.verdict, found.remainder.share_percent) == ("sufficient", 100.0)
    assert (found.remainder.depends_on, found.remainder.unexplained) == ((), False)
    assert (found.gain_percent, found.gain_interval_percent) == (0.0, (0.0, 0.0))
    rest = diagnosed(Searched({NOTHING: 9.0, terms("delay"): 8.99}), terms("delay"))
    assert (rest.verdict, rest.remainder.unexplained) == ("unexplained", True)
    assert rest.remainder.depends_on == ("time_s",)


def test_where_nothing_was_beyond_the_noise_no_share_is_left(diagnosed):
    found = diagnosed(Searched({NOTHING: 0.9, terms("delay"): 0.5}), terms("delay"))
    assert (found.verdict, found.remainder.share_percent) == ("named", 0.0)
    assert not found.remainder.unexplained
    quiet = diagnosed(Searched({NOTHING: 17.0, terms("delay"): 1.14}), terms("delay"))
    assert (quiet.remainder.share_percent, quiet.remainder.depends_on) == (0.0, ())


@pytest.mark.parametrize(("blocks", "verdict"), [(5, "undecided"), (6, "named")])
def test_too_few_blocks_decide_nothing(diagnosed, blocks, verdict):
    search = Searched({NOTHING: 17.0, terms("delay"): 1.0}, blocks=blocks)
    assert diagnosed(search, terms("delay")).verdict == verdict


def test_a_stated_frequency_makes_the_equation_nominal(diagnosed):
    """Then the spring of the equation is no cause; what it gains counts against that."""
    squares = {STATED: 9.0, terms("spring"): 8.99, STATED | {"delay"}: 1.0}
    same = diagnosed(Searched(squares, stated=30.0), terms("spring"))
    assert (same.nominal, same.named) == (EQUATION_NAME, ())
    better = diagnosed(Searched({STATED: 9.0, terms("spring"): 1.0}, stated=30.0), terms("spring"))
    (cause,) = better.named
    assert (cause.effect, cause.kind) == ("drive_compliance", "")
    assert list(cause.parameters) == ["damping_ratio"]
    own = diagnosed(Searched({STATED: 9.0}, stated=30.0), STATED)
    assert own.named == ()


def test_a_drive_that_shows_no_resonance_is_held_against_a_stiff_one(diagnosed):
    """Sentence and JSON named a compliance without a number, which no table showed."""
    squares = {STATED: 99.0, NOTHING: 9.0, terms("lag"): 1.0}
    search = Searched(squares, stated=30.0, rivals={"lag": ("spring",)})
    found = diagnosed(search, terms("lag"))
    assert (found.verdict, found.nominal) == ("ambiguous", STIFF_NAME)
    (cause,) = found.named
    assert (cause.effect, cause.rivals) == ("channel_delay", ("drive_compliance",))
    assert "compliance of the drive, whose" not in found.reason
    stiff = diagnosed(Searched({STATED: 99.0, NOTHING: 1.0}, stated=30.0), NOTHING)
    assert (stiff.verdict, stiff.nominal, stiff.named) == ("sufficient", STIFF_NAME, ())


def test_what_the_nominal_equation_does_as_well_is_no_cause(diagnosed):
    """A lag was named whose RMS before and after was 0.00506 mm."""
    squares = {STATED: 1.001, NOTHING: 9.0, terms("lag"): 1.0}
    found = diagnosed(Searched(squares, stated=30.0), terms("lag"))
    assert (found.verdict, found.nominal, found.named) == ("sufficient", EQUATION_NAME, ())


@pytest.mark.parametrize(
    ("rivals", "told"),
    [
        ({"lag": ("delay", "play")}, {"channel_delay": ("channel_delay (pure delay)", "backlash")}),
        ({"spring": ("delay",)}, {"drive_compliance": ("channel_delay (pure delay)",)}),
        ({"spring": ("play",)}, {"drive_compliance": ("backlash",)}),
    ],
)
def test_rivals_are_effects_or_the_other_kind_of_a_delay_that_is_named(diagnosed, rivals, told):
    both = terms("spring", "lag")
    squares = {NOTHING: 99.0, both: 1.0, terms("spring"): 9.0, terms("lag"): 9.0}
    found = diagnosed(Searched(squares, rivals=rivals), both)
    assert found.verdict == "ambiguous"
    nobody = {"drive_compliance": (), "channel_delay": ()}
    assert {c.effect: c.rivals for c in found.named} == nobody | told


def test_two_terms_of_one_effect_are_one_cause_without_rivals(diagnosed):
    both = terms("lag", "delay")
    search = Searched({NOTHING: 9.0, both: 1.0}, rivals={"lag": ("play",)})
    (cause,) = diagnosed(search, both).named
    assert (cause.kind, cause.rivals) == ("pure delay and first-order lag", ())


def test_each_cause_is_held_against_all_the_others(diagnosed):
    """Play gains on the delay alone, and the other way round."""
    both = terms("delay", "play")
    squares = {NOTHING: 16.0, terms("delay"): 4.0, terms("play"): 9.0, both: 1.0}
    found = diagnosed(Searched(squares), both)
    gains = {c.effect: c.gain_percent for c in found.named}
    assert gains == pytest.approx({"channel_delay": 100.0 * 2.0 / 3.0, "backlash": 50.0})
    assert list(gains) == ["channel_delay", "backlash"]
    idle = diagnosed(Searched(squares | {terms("delay"): 1.01}), both)
    assert [c.effect for c in idle.named] == ["channel_delay"]


PLAIN = "A drive without lag and stiffness, x_in = g ∫u dt,"


def reason(found):
    return dd.reason_of(found, 9.0, 1.44)


def test_the_reason_of_each_verdict():
    assert reason(verdict("undecided")).startswith("too few stretches")
    quiet = reason(verdict("sufficient"))
    assert quiet == f"{PLAIN} is at the noise level: these runs show no missing effect."
    assert reason(verdict("unexplained", depends=("time_s", "x_in_mm"))) == (
        f"{PLAIN} leaves a residual RMS of x_in of 3 × the noise level, and no catalogued effect "
        "of a drive explains it. It depends on time_s, x_in_mm."
    )
    stated = reason(verdict("sufficient", stated=True))
    assert stated.startswith("The nominal drive equation (Yang 2025, Eq. 25, without reaction) is")


def test_the_reason_names_causes_rivals_and_the_rest():
    spring = cause("drive_compliance", rivals=("backlash", "drive_ripple"))
    delay = cause("channel_delay", "pure delay", ("backlash",))
    found = verdict("ambiguous", spring, delay, unexplained=True, depends=("time_s",))
    assert reason(found) == (
        f"{PLAIN} leaves a residual RMS of x_in of 3 × the noise level. It lacks: the compliance "
        "of the drive, whose stiffness reacts on the position and a pure delay of the motor. With "
        "it the residual RMS is 1.2 × the noise level. These recordings do not distinguish the "
        "compliance of the drive, whose stiffness reacts on the position from backlash or "
        "drive_ripple. These recordings do not distinguish a pure delay of the motor from "
        "backlash. No catalogued effect explains the remaining residual. It depends on time_s."
    )
    plain = reason(verdict("named", cause("backlash")))
    assert f"It lacks: the {TITLE['backlash'].lower()}. With" in plain
    assert plain.endswith("With it the residual RMS is 1.2 × the noise level.")


def searched(residual):
    """Two runs of half of the residual each, in blocks of ten samples, held out in turns."""
    size = residual.size // 2
    u = sampled(0.01, 300.0 * np.sin(0.05 * np.arange(size)), "first")
    runs = [DriveRun("a", u, 0.02 * u.integral, noise, at_rest=True) for noise in (1.0, 2.0)]
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
