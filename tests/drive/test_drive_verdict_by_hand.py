"""From the terms of a drive to a verdict, its causes, its sentence, and what is written of it."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.channel_errors import Channel
from tsas_cli.diagnosis.evidence import gain
from tsas_cli.drive import diagnosis as dd
from tsas_cli.drive import json as dj
from tsas_cli.drive.diagnosis import DriveCause, DriveDiagnosis
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.frequency_response import FrequencyResponse
from tsas_cli.drive.harmonic_drive import DriveValues
from tsas_cli.drive.search import NOTHING
from tsas_cli.drive.tables import tables
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.base import parameters_of
from tsas_cli.records.drive import Drive, DriveRun, Kinematics, TriedStructure

TITLE = {e.name: e.title for e in EFFECTS}
STATED = frozenset({"stated"})
TOLD = {
    name: Estimate(name, 0.5, name.rpartition("_")[2], "fitted", None, 0.1, 0.3, 0.7)
    for name in ("delay_s", "motor_lag_s", "play_mm", "damping_ratio", "gain_mm_per_s_rpm")
}


def terms(*names):
    return frozenset(names)


class Searched:
    """Held-out mean squares by set of terms, even over twenty blocks of ten residuals."""

    def __init__(self, squares, *, stated=None, blocks=20, rivals=()):
        self.given, self.rivals = squares, dict(rivals)
        self.bench = SimpleNamespace(stated_Hz=stated, runs=[SimpleNamespace(noise_mm=0.1)])
        block = np.arange(10 * blocks) // 10
        self.folds = SimpleNamespace(
            block=block, run=np.zeros(block.size, int), blocks=blocks, by_run=False
        )

    def held_out(self, names):
        return np.full(self.folds.blocks, 10.0 * self.given[names])

    def mean_square(self, names):
        return self.given[names]

    def gain(self, before, after):
        return gain(self.held_out(before), self.held_out(after))


@pytest.fixture
def diagnosed(monkeypatch):
    monkeypatch.setattr(dd, "_left", lambda search, terms: (("time_s",), 0.36))
    monkeypatch.setattr(dd, "rivals", lambda search, final, term: search.rivals.get(term, ()))
    return lambda search, final: dd.diagnose_drive(search, final, TOLD)


def test_a_delay_is_named_with_its_gain_and_what_is_left(diagnosed):
    """Of 17 − 1 there is left 1.95 − 1 − 0.15: a twentieth."""
    found = diagnosed(Searched({NOTHING: 17.0, terms("delay"): 1.95}), terms("delay"))
    assert (found.verdict, found.nominal, found.final) == ("named", NOTHING, terms("delay"))
    (cause,) = found.causes
    assert (cause.effect, cause.kind, cause.rivals) == ("channel_delay", "pure delay", ())
    assert [e.name for e in cause.parameters] == ["motor_lag_s", "delay_s"]
    percent = 100.0 * (1.0 - math.sqrt(1.95 / 17.0))
    assert cause.gain_percent == pytest.approx(percent)
    assert cause.gain_interval_percent == pytest.approx((percent, percent))
    assert found.gain_percent == pytest.approx((percent,) * 3)
    assert found.share_left == pytest.approx(0.8 / 16.0)
    assert found.mean_square == 1.95
    assert found.unexplained  # a twentieth is more than a fiftieth
    assert found.depends_on == ("time_s",)


def test_errors_of_the_drive_are_in_millimetres(diagnosed):
    found = diagnosed(Searched({NOTHING: 16.0, terms("delay"): 4.0}), terms("delay")).channel
    assert (found.rmse_before, found.rmse_after) == pytest.approx((0.4, 0.2))
    assert found.noise_floor == pytest.approx(0.1)
    assert found.best_obtainable == pytest.approx(0.2 * 0.8)  # √(1 − 0.36)
    low = diagnosed(Searched({NOTHING: 16.0, terms("delay"): 0.25}), terms("delay")).channel
    assert low.noise_floor == low.best_obtainable == pytest.approx(0.05)
    near = diagnosed(Searched({NOTHING: 16.0, terms("delay"): 1.21}), terms("delay")).channel
    assert near.best_obtainable == pytest.approx(0.1)


def test_without_a_cause_the_nominal_equation_stays(diagnosed):
    found = diagnosed(Searched({NOTHING: 1.0, terms("delay"): 0.99}), terms("delay"))
    assert (found.verdict, found.final, found.share_left) == ("sufficient", NOTHING, 1.0)
    assert (found.depends_on, found.unexplained) == ((), False)
    assert found.gain_percent == (0.0, 0.0, 0.0)
    rest = diagnosed(Searched({NOTHING: 9.0, terms("delay"): 8.99}), terms("delay"))
    assert (rest.verdict, rest.unexplained, rest.depends_on) == ("unexplained", True, ("time_s",))


def test_where_nothing_was_beyond_the_noise_no_share_is_left(diagnosed):
    found = diagnosed(Searched({NOTHING: 0.9, terms("delay"): 0.5}), terms("delay"))
    assert (found.verdict, found.share_left, found.unexplained) == ("named", 0.0, False)
    quiet = diagnosed(Searched({NOTHING: 17.0, terms("delay"): 1.14}), terms("delay"))
    assert (quiet.share_left, quiet.depends_on) == (0.0, ())


@pytest.mark.parametrize(("blocks", "verdict"), [(5, "undecided"), (6, "named")])
def test_too_few_blocks_decide_nothing(diagnosed, blocks, verdict):
    search = Searched({NOTHING: 17.0, terms("delay"): 1.0}, blocks=blocks)
    assert diagnosed(search, terms("delay")).verdict == verdict


def test_a_stated_frequency_makes_the_equation_nominal(diagnosed):
    """Then the spring of the equation is no cause; what it gains counts against that."""
    squares = {STATED: 9.0, terms("spring"): 8.99, STATED | {"delay"}: 1.0}
    same = diagnosed(Searched(squares, stated=30.0), terms("spring"))
    assert (same.nominal, same.causes) == (STATED, ())
    better = diagnosed(Searched({STATED: 9.0, terms("spring"): 1.0}, stated=30.0), terms("spring"))
    (cause,) = better.causes
    assert (cause.effect, cause.kind) == ("drive_compliance", "")
    assert [e.name for e in cause.parameters] == ["damping_ratio"]
    own = diagnosed(Searched({STATED: 9.0}, stated=30.0), STATED)
    assert own.causes == ()


def test_rivals_are_effects_or_the_other_kind_of_delay(diagnosed):
    squares = {NOTHING: 9.0, terms("lag"): 1.0}
    search = Searched(squares, rivals={"lag": ("delay", "play")})
    found = diagnosed(search, terms("lag"))
    assert found.verdict == "ambiguous"
    assert found.causes[0].rivals == ("channel_delay (pure delay)", "backlash")


def test_two_terms_of_one_effect_are_one_cause_without_rivals(diagnosed):
    both = terms("lag", "delay")
    search = Searched({NOTHING: 9.0, both: 1.0}, rivals={"lag": ("play",)})
    (cause,) = diagnosed(search, both).causes
    assert (cause.kind, cause.rivals) == ("pure delay and first-order lag", ())


def test_each_cause_is_held_against_all_the_others(diagnosed):
    """Play gains on the delay alone, and the other way round."""
    both = terms("delay", "play")
    squares = {NOTHING: 16.0, terms("delay"): 4.0, terms("play"): 9.0, both: 1.0}
    found = diagnosed(Searched(squares), both)
    gains = {c.effect: c.gain_percent for c in found.causes}
    assert gains == pytest.approx({"channel_delay": 100.0 * 2.0 / 3.0, "backlash": 50.0})
    assert list(gains) == ["channel_delay", "backlash"]
    idle = diagnosed(Searched(squares | {terms("delay"): 1.01}), both)
    assert [c.effect for c in idle.causes] == ["channel_delay"]


def cause(effect, kind="", rivals=()):
    return DriveCause(effect, kind, rivals, (TOLD["play_mm"],), 40.0, (30.0, 50.0))


def verdict(name, *causes, nominal=NOTHING, unexplained=False, depends=(), left=1.44):
    return DriveDiagnosis(
        name, "why", nominal, terms("play"), causes, Channel(0.4, 0.2, 0.1, 0.15),
        (40.0, 30.0, 50.0), left, 0.05, unexplained, depends,
    )  # fmt: skip


PLAIN = "A drive without lag and stiffness, x_in = g ∫u dt,"


def test_the_reason_of_each_verdict():
    assert dd._reason(verdict("undecided"), 9.0).startswith("too few stretches")
    quiet = dd._reason(verdict("sufficient"), 9.0)
    assert quiet == f"{PLAIN} is at the noise floor: nothing is missing that these runs show."
    rest = verdict("unexplained", depends=("time_s", "x_in_mm"))
    assert dd._reason(rest, 9.0) == (
        f"{PLAIN} misses x_in by 3 times what noise explains, and no known effect of a drive "
        "accounts for it. It depends on time_s, x_in_mm."
    )
    stated = dd._reason(verdict("sufficient", nominal=STATED), 9.0)
    assert stated.startswith("The nominal drive equation (Yang 2025, Eq. 25, without reaction) is")


def test_the_reason_names_causes_rivals_and_the_rest():
    two = (
        cause("drive_compliance", rivals=("b", "a")),
        cause("channel_delay", "pure delay", ("a",)),
    )
    said = dd._reason(verdict("ambiguous", *two, unexplained=True, depends=("time_s",)), 9.0)
    assert said == (
        f"{PLAIN} misses x_in by 3 times what noise explains. What it lacks is: the compliance of "
        "the drive, whose stiffness reacts on the position and a pure delay of the motor. With "
        "that it is 1.2 times. These recordings cannot tell it from: a, b. What is left no known "
        "effect explains. It depends on time_s."
    )
    plain = dd._reason(verdict("named", cause("backlash")), 9.0)
    assert f"What it lacks is: the {TITLE['backlash'].lower()}. With" in plain
    assert plain.endswith("With that it is 1.2 times.")


SHEET = DataSheet(27.1, 120.0, 0.13, 2.3)


def test_the_lead_is_held_against_kinematics():
    """60 · 120/(2π · 27.1) rpm for each mm/s; fitted a quarter above it."""
    lead = 60.0 * 120.0 / (2.0 * math.pi * 27.1)
    fitted = {"kV_rpm_s_per_mm": Estimate("kV_rpm_s_per_mm", 1.25 * lead, "", "fitted")}
    found = dj.kinematics(SHEET, fitted)
    assert found.kinematic_lead_rpm_s_per_mm == pytest.approx(lead)
    assert found.kinematic_gain_mm_per_s_rpm == pytest.approx(1.0 / lead)
    assert found.fitted_above_kinematic_percent == pytest.approx(25.0)
    assert found.fitted_lead_rpm_s_per_mm == pytest.approx(1.25 * lead)
    none = dj.kinematics(DataSheet(None, None, None, None), fitted)
    assert none.kinematic_lead_rpm_s_per_mm is none.fitted_above_kinematic_percent is None


def seen(frequency, response=None, excited=None):
    frequency = np.asarray(frequency, dtype=float)
    response = np.ones(frequency.size, complex) if response is None else response
    excited = np.ones(frequency.size, bool) if excited is None else np.asarray(excited)
    return FrequencyResponse(frequency, response, np.ones(frequency.size), excited)


def test_poles_of_a_lag_a_delay_and_a_spring():
    """1/(2π τ), 1/(2π T), and the natural frequency; the integrator is none."""
    values = DriveValues(0.02, motor_lag_s=0.1, delay_s=0.05)
    lag, delay = dj.pole_rows(values, seen([0.5, 3.0]))
    assert (lag.kind, lag.real_per_s, lag.imaginary_per_s) == (
        "pole",
        pytest.approx(-10.0),
        0.0,
    )
    assert lag.frequency_Hz == pytest.approx(10.0 / (2.0 * math.pi))
    assert (delay.kind, delay.real_per_s) == ("1/delay", -20.0)
    assert delay.frequency_Hz == pytest.approx(20.0 / (2.0 * math.pi))
    assert lag.in_band
    assert not delay.in_band  # 3.18 Hz, a little more than 1.05 · 3
    springy = DriveValues(0.02, natural_frequency_Hz=4.0, damping_ratio=0.6)
    (one,) = dj.pole_rows(springy, seen([0.5, 9.0]))
    assert one.frequency_Hz == pytest.approx(4.0)
    assert one.real_per_s == pytest.approx(-0.6 * 8.0 * math.pi)
    assert one.imaginary_per_s == pytest.approx(0.8 * 8.0 * math.pi)
    assert dj.pole_rows(DriveValues(0.02), seen([0.5, 9.0])) == []


@pytest.mark.parametrize(
    ("band", "inside"),
    [
        ((1.0, 1.92), True),
        ((1.0, 1.89), False),
        ((2.08, 9.0), True),
        ((2.11, 9.0), False),
        (None, False),
    ],
)
def test_a_pole_is_in_the_band_or_a_twentieth_beside_it(band, inside):
    """At 2 Hz."""
    dark = seen([1.0, 2.0], excited=[False, False])
    (row,) = dj.pole_rows(
        DriveValues(0.02, motor_lag_s=1.0 / (4.0 * math.pi)), dark if band is None else seen(band)
    )
    assert row.in_band == inside


@pytest.mark.parametrize("turn", [0, 1, -2])
def test_measured_phases_are_on_the_turn_of_the_fitted_ones(monkeypatch, turn):
    """An integrator has −90°; what is not excited tells no turn."""
    frequency = np.linspace(1.0, 5.0, 5)
    response = 0.02 / (2j * math.pi * frequency)
    monkeypatch.setattr(
        dj,
        "bode_curve",
        lambda values, at: (0.02 / (2.0 * math.pi * at), np.full(at.size, -90.0 + 360.0 * turn)),
    )
    values = DriveValues(0.02)
    found = dj.response(seen(frequency, response, [False, False, True, True, False]), values)
    assert found.band_Hz == (3.0, 4.0)
    np.testing.assert_allclose(found.measured.phase_deg, -90.0 + 360.0 * turn)
    np.testing.assert_allclose(found.measured.magnitude, np.abs(response))
    curve = found.fitted.frequency_Hz
    assert (curve[0], curve[-1], len(curve)) == (pytest.approx(1.0), pytest.approx(5.0), 200)
    np.testing.assert_allclose(np.diff(np.log(curve)), math.log(5.0) / 199)
    dark = dj.response(seen(frequency, response, [False] * 5), values)
    assert dark.band_Hz is None
    np.testing.assert_allclose(dark.measured.phase_deg, -90.0)


def test_the_turn_is_told_by_the_first_frequency_that_is_excited(monkeypatch):
    """The fitted phase falls from 0 to −720°: at 2 Hz it is −180°, where −90° is nearest."""
    frequency = np.linspace(1.0, 5.0, 5)
    monkeypatch.setattr(
        dj, "bode_curve", lambda values, at: (at, np.interp(at, [1.0, 5.0], [0.0, -720.0]))
    )
    told = seen(frequency, np.full(5, -1j), [False, True, True, True, True])
    near = dj.response(told, DriveValues(0.02)).measured.phase_deg
    np.testing.assert_allclose(near, -90.0)
    late = seen(frequency, np.full(5, -1j), [False, False, False, True, True])
    far = dj.response(late, DriveValues(0.02)).measured.phase_deg
    np.testing.assert_allclose(far, -450.0)  # beside −540°


def test_structures_are_listed_with_the_chosen_one(monkeypatch):
    chosen = terms("lag", "play")
    asked = []

    def structures(gear):
        asked.append(gear)
        return [terms("play"), chosen]

    monkeypatch.setattr(dj, "structures", structures)

    def trial(names):
        return SimpleNamespace(mean_square=4.0, solution=SimpleNamespace(converged=True))

    search = SimpleNamespace(trial=trial, mean_square=lambda names: 9.0)
    simple, lag = dj.structure_rows(search, chosen)
    assert asked == [terms("play")]
    assert (simple.name, lag.name) == ("integrator", "integrator with lag")
    assert (simple.chosen, lag.chosen) == (False, True)
    assert lag.parameters - simple.parameters == 1
    assert (lag.held_out_times_noise, lag.times_noise) == (3.0, 2.0)


def test_each_run_has_the_errors_of_both():
    run = SimpleNamespace(
        id="a",
        x_in=np.array([1.0, 2.0]),
        u=SimpleNamespace(step_s=0.004),
        noise_mm=0.1,
        counts=np.ones(2, dtype=bool),
        at_rest=True,
    )
    search = SimpleNamespace(bench=SimpleNamespace(runs=[run]))
    found = dj.run_rows(search, [np.array([4.0, -2.0])], [np.array([2.0, 9.0])])["a"]
    assert found.rmse == pytest.approx(math.sqrt((9.0 + 16.0) / 2.0))
    assert found.rmse_nominal == pytest.approx(5.0)
    assert (found.samples, found.rate_Hz, found.noise) == (2, 250.0, 0.1)
    with pytest.raises(ValueError, match="zip"):
        dj.run_rows(search, [np.zeros(2)] * 2, [np.zeros(2)])


def test_a_diagnosis_of_a_drive_as_json_and_as_tables():
    search = SimpleNamespace(folds=SimpleNamespace(by_run=True, blocks=40))
    named = verdict("ambiguous", cause("backlash", rivals=("channel_delay",)), nominal=STATED)
    found = dj.diagnosis(search, named)
    (row,) = found.named
    assert (row.effect, row.title) == ("backlash", TITLE["backlash"])
    assert row.parameters["play_mm"].interval_high == 0.7
    written = row.content()["parameters"]["play_mm"]
    assert set(written).isdisjoint({"name", "run", "origin"})
    assert (found.gain_percent, found.gain_interval_percent) == (40.0, (30.0, 50.0))
    assert found.nominal.startswith("Eq. (25)")
    assert found.remainder.share_percent == pytest.approx(5.0)
    assert found.evidence.held_out == "runs"
    assert found.evidence.sentence.startswith("Each run is predicted by a fit to the others; 40")
    search.folds.by_run = False
    stretches = dj.diagnosis(search, verdict("sufficient"))
    assert stretches.nominal == "x_in = g ∫u dt"
    assert stretches.evidence.sentence.startswith("Stretches are predicted by a fit to the")

    tried = TriedStructure(name="lag", parameters=2, held_out_times_noise=1.2345)
    lead = Kinematics(kinematic_lead_rpm_s_per_mm=42.2841, fitted_lead_rpm_s_per_mm=40.0)
    drive = Drive.model_construct(
        parameters=parameters_of([TOLD["play_mm"]]),
        kinematics=lead,
        diagnosis=found,
        structures=(
            tried.model_copy(update={"chosen": True}),
            tried,
            tried.model_copy(update={"converged": False}),
        ),
        runs={"a": DriveRun(rmse=0.12344, rmse_nominal=0.5, noise=0.0123)},
    )
    structures, parameters, runs, causes, error = (rows for *_, rows in tables(drive, "title"))
    assert [row[3] for row in structures] == ["chosen", "", "not converged"]
    assert structures[0][:3] == ("lag", "2", "1.23")
    assert parameters[0] == ("play_mm", "0.5 [0.3, 0.7]", "mm")
    assert parameters[1][1] == "42.284"
    assert list(runs) == [("a", "0.1234", "0.5", "0.012")]
    assert causes == [("backlash", "play_mm", "0.5 [0.3, 0.7]", "mm", "40.0", "channel_delay")]
    assert error == [("x_in_mm", "0.4", "0.2", "0.1", "0.15", "mm")]
    less = {"kinematics": Kinematics(fitted_lead_rpm_s_per_mm=40.0), "diagnosis": stretches}
    fewer = list(tables(drive.model_copy(update=less), "title"))
    assert len(fewer) == 4
    assert len(fewer[1][2]) == 1
