"""A law of unnamed origin for what the independent rig hides and no catalogue holds."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import law as law_module
from tsas_cli.diagnosis import law_bench
from tsas_cli.diagnosis.channel_errors import noise_floor
from tsas_cli.diagnosis.diagnose import bench_folds
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.law import _excess, _taken, _worse, describe
from tsas_cli.diagnosis.law_bench import folds_by_tension, priors_of
from tsas_cli.diagnosis.law_words import after_reversal, records_of, sentence_of
from tsas_cli.diagnosis.moments import LATE
from tsas_cli.diagnosis.nominal import nominal_fit
from tsas_cli.diagnosis.refitted import HeldOutFit
from tsas_cli.diagnosis.remainder import remainder
from tsas_cli.diagnosis.signals import signals_at_residuals
from tsas_cli.diagnosis.tolerances import (
    rigs_with_tolerances,
    tolerances,
    without_tolerances,
)
from tsas_cli.effects import LAWS
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model_file import stated_model
from tsas_cli.identification.prepared import prepare
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate
from tsas_studies.challenge.rig.transducers import Transducer

PLAY_MM, NOISE_MM = 0.15, 0.01
RIG = Rig(cells=60)


@cache
def clean(amplitude):
    return simulate(RIG, sine(amplitude, rate_Hz=200.0))


def bench_for(folder, sensors):
    """Return the bench of three runs of other amplitudes."""
    runs = [
        Run(name, measure(clean(amplitude), sensors, seed=k), conditions(RIG))
        for k, (name, amplitude) in enumerate((("a", 6.0), ("b", 8.0), ("c", 10.0)))
    ]
    data = read_dataset(write_dataset(folder, runs))
    prepared = [prepare(recording) for recording in data]
    return bench_of(
        solve_fit(nominal_fit(data.manifest, stated_model(data.manifest, None), prepared))
    )


def described(folder, sensors):
    """Return the law that describes the runs."""
    bench = bench_for(folder, sensors)
    return describe(bench, bench.fit(), bench_folds(bench))


def test_play_of_an_encoder_is_lost_motion_at_the_load(tmp_path):
    sensors = Sensors(rate_Hz=40.0)
    sensors = replace(sensors, x_out_transducer=Transducer(play=PLAY_MM))
    law = described(tmp_path / "dataset", sensors)
    assert law.names == ("load_law",)
    assert law.before.rmse["x_out_mm"] > 4.0 * NOISE_MM
    assert law.after.rmse["x_out_mm"] < 1.3 * NOISE_MM  # on runs that no fit saw
    assert law.after.rmse["f_in_N"] == pytest.approx(law.before.rmse["f_in_N"], rel=0.05)
    (said,) = records_of(law)
    value = {name: p.value for name, p in said.parameters.items()}
    lost = 2.0 * sum(value[f"lost_{k}_mm"] for k in range(1, 7))
    assert lost == pytest.approx(PLAY_MM, rel=0.15)
    assert "motion are lost at each reversal" in said.sentence
    within = np.array(said.travel_mm)[np.array(said.after_reversal) > 0.9 * lost][0]
    assert within < 2.5 * PLAY_MM
    assert 0.0 < said.after_reversal_margin[-1] < 0.2 * PLAY_MM
    assert abs(said.after_reversal[-1] - PLAY_MM) < 2.0 * said.after_reversal_margin[-1]


def test_a_parameter_that_does_as_much_as_the_residual_costs_a_tenth_of_a_block():
    """RMS 0.05 mm and 2 N at a mean tension of 20 N, in 4 blocks of 25."""
    signals = {"f_in_N": np.full(8, -20.0), "f_out_N": None}
    run = SimpleNamespace(
        run=SimpleNamespace(channel=signals.get),
        samples={"f_in_N": np.arange(8), "x_out_mm": np.arange(8)},
        weights={"f_in_N": np.full(8, 2.0), "x_out_mm": np.full(8, 0.05)},
    )
    bench = SimpleNamespace(closed=(run,), channels=("f_in_N", "x_out_mm"))
    without = SimpleNamespace(solution=SimpleNamespace(residual=np.full(4, 5.0)))
    priors = priors_of(bench, without, SimpleNamespace(blocks=4))

    def cost(name, value):
        return (priors[name] * QUANTITIES[name].scaled(value)) ** 2

    assert cost("drive_law.friction_3_N", 2.0) == pytest.approx(2.5)
    assert cost("drive_law.gap_share_1", 0.1) == pytest.approx(2.5)
    assert cost("drive_law.place_2", 0.1) == pytest.approx(2.5)
    assert cost("drive_law.speed_2", 0.3) == pytest.approx(2.5)
    assert cost("load_law.lost_2_mm", 0.05) == pytest.approx(2.5)
    assert cost("load_law.compliance_mm_per_N", 0.0025) == pytest.approx(2.5)
    assert cost("tendon_law.start_1", -0.3) == pytest.approx(2.5)
    assert not any(QUANTITIES[name].given for name in priors)


@pytest.mark.parametrize(
    ("highest_N", "fold"),
    [
        ((10.0, 50.0, 11.0, 52.0), [0, 1, 0, 1]),
        ((10.0, 12.0, 14.0, 17.0), None),  # each within a quarter of the next
        ((10.0, 20.0, 40.0, 80.0), None),  # the folds are runs already
    ],
)
def test_runs_of_like_tension_are_held_out_together(highest_N, fold):
    def run(highest):
        return SimpleNamespace(run=SimpleNamespace(channel=lambda name: np.full(9, -highest)))

    bench = SimpleNamespace(closed=[run(highest) for highest in highest_N])
    by_run = np.repeat(np.arange(4), 3)
    found = folds_by_tension(bench, Folds(by_run, np.arange(12), by_run, by_run=True))
    assert (found and found.fold[::3].tolist()) == fold
    stretches = Folds(by_run, np.arange(12), by_run, by_run=False)
    assert folds_by_tension(bench, stretches) is None


def test_a_cost_that_holds_the_law_back_is_lowered_while_held_out_runs_gain(tmp_path, monkeypatch):
    sensors = replace(Sensors(rate_Hz=40.0), x_out_transducer=Transducer(play=PLAY_MM))
    monkeypatch.setattr(law_bench, "PRIOR", 10.0)
    lowered = described(tmp_path / "lowered", sensors)
    monkeypatch.setattr(law_module, "LIGHTER", 0)
    held_back = described(tmp_path / "held-back", sensors)
    assert held_back.after.rmse["x_out_mm"] > 2.0 * NOISE_MM
    assert lowered.after.rmse["x_out_mm"] < NOISE_MM
    name = "load_law.lost_1_mm"
    assert lowered.bench.priors[name] == pytest.approx(held_back.bench.priors[name] * 0.3**2)


@pytest.mark.parametrize(
    ("effect", "beside"), [("force_sensor_tilt", ("force_sensor_tilt",)), ("load_damping", ())]
)
def test_a_law_acts_beside_what_is_not_proven_where_that_predicts_better(tmp_path, effect, beside):
    """A cell tilts by 5 % over the stroke, which no law describes; no load is damped."""
    sensors = Sensors(rate_Hz=40.0, f_out_tilt_per_mm=0.005)
    sensors = replace(sensors, x_out_transducer=Transducer(play=PLAY_MM))
    bench = bench_for(tmp_path / "dataset", sensors)
    unproven = bench.fit([effect])
    law = describe(bench, bench.fit(), bench_folds(bench), unproven=unproven)
    assert law.beside == beside
    assert {record.beside for record in records_of(law)} == {beside}
    assert "load_law" in law.names
    assert law.after.rmse["x_out_mm"] < 1.3 * NOISE_MM


def test_a_sound_rig_has_no_law(tmp_path):
    assert described(tmp_path / "dataset", Sensors(rate_Hz=40.0)) is None


def mean_delay(bench, rigs):
    delays = [run.delays(rig)["f_out_N"] for run, rig in zip(bench.meshed, rigs, strict=True)]
    return float(np.concatenate(delays).mean())


def test_a_load_cell_that_feels_the_other_a_little_explains_what_lags_at_reversals(tmp_path):
    """Where strokes turn, residuals have no weight: the tolerances are known from the others."""
    bench = bench_for(tmp_path / "dataset", Sensors(rate_Hz=40.0, f_out_of_f_in=0.003))
    trial, folds = bench.fit(), bench_folds(bench)
    tolerated = tolerances(bench, trial)
    fitted = [bench.rig(trial, k) for k in range(3)]
    rigs = rigs_with_tolerances(bench, trial, tolerated, folds.run)
    residual = [run.residuals(rig) for run, rig in zip(bench.meshed, rigs, strict=True)]
    linear = without_tolerances(trial, tolerated, folds.run)
    assert np.mean(np.concatenate(residual) ** 2) == pytest.approx(np.mean(linear**2), rel=0.02)
    assert mean_delay(bench, fitted) < -LATE
    assert abs(mean_delay(bench, rigs)) < 0.1 * LATE
    assert remainder(bench, trial, folds, signals_at_residuals(bench, trial), tolerated).late == ()


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_tolerances_move_no_parameter_out_of_its_bounds(tmp_path, sense):
    """Of a tolerance that does what a travel does, and more; the residual has two of it."""
    bench = bench_for(tmp_path / "dataset", Sensors(rate_Hz=40.0))
    trial, folds = bench.fit(["presliding"]), bench_folds(bench)
    at = [u.name for u in trial.unknowns].index("presliding.length_mm")
    of_travel = trial.solution.jacobian[:, at]
    more = 10.0 * np.random.default_rng(3).standard_normal(of_travel.size)
    tolerated = np.zeros_like(tolerances(bench, trial))
    tolerated[:, 0] = sense * 10.0 * of_travel + more
    moved = replace(trial, solution=replace(trial.solution, residual=2.0 * more))
    rigs = rigs_with_tolerances(bench, moved, tolerated, folds.run)
    lengths_mm = {rig.effects.presliding.length_mm for rig in rigs}
    assert len(lengths_mm) == 1
    assert min(lengths_mm) >= 0.0
    assert (min(lengths_mm) > trial.values()["presliding.length_mm"]) == (sense > 0.0)


@pytest.mark.parametrize(
    ("force", "length", "worse"),
    [
        ((0.9, 0.9), (1.04, 1.04), True),  # a channel over all runs
        ((0.5, 1.0), (1.0, 1.07), True),  # a run over both channels
        ((0.9, 0.9), (1.04, 1.0), False),  # a little of one channel for more of another
    ],
)
def test_a_law_that_makes_a_run_or_a_channel_worse_is_refused(force, length, worse):
    def errors(force, length):
        by_run = {(k, "f_in_N"): 2.0 * f for k, f in enumerate(force)}
        by_run |= {(k, "x_out_mm"): 0.01 * x for k, x in enumerate(length)}
        rmse = {
            name: np.sqrt(np.mean([v**2 for (_, n), v in by_run.items() if n == name]))
            for name in ("f_in_N", "x_out_mm")
        }
        return HeldOutFit(rmse, {}, np.zeros(0), by_run, {})

    plain = errors((1.0, 1.0), (1.0, 1.0))
    assert _worse(plain, errors(force, length)) == worse
    assert not _worse(plain, plain)


def test_the_share_that_exceeds_the_noise_and_the_share_that_a_law_takes(tmp_path):
    """Of 3 times the noise 8 of 9 parts of the squares exceed it; 5 parts left are 4 taken."""
    bench = bench_for(tmp_path, Sensors(rate_Hz=40.0))
    noise = {name: noise_floor(bench, name, 0.0) for name in bench.channels}

    def held_out(squares):
        rmse = {name: floor * np.sqrt(squares) for name, floor in noise.items()}
        return HeldOutFit(rmse, {}, np.zeros(0), {}, {})

    assert _excess(noise, held_out(9.0)) == pytest.approx(8.0 / 9.0)
    assert _excess(noise, held_out(0.9)) == 0.0
    assert _taken(held_out(9.0), held_out(5.0)) == pytest.approx(4.0 / 9.0)
    assert _taken(held_out(5.0), held_out(9.0)) == pytest.approx(-4.0 / 5.0)


NOTHING = {law.name: {p.name: p.neutral for p in law.parameters} for law in LAWS}
TENSIONS = (5.0, 25.0)


def said(name, **values):
    return sentence_of(name, NOTHING[name] | values, TENSIONS)


@pytest.mark.parametrize("name", NOTHING)
def test_a_law_of_nothing_says_nothing(name):
    assert said(name) == ""


def test_friction_at_the_drive_is_twice_the_weights_and_grows_with_the_tension():
    """1 N and a tenth of 5 to 25 N, both ways: 3 N to 7 N."""
    assert said("drive_law", friction_1_N=1.0) == (
        "At the drive friction changes f_in by 2 N after each reversal, within 1.8 mm."
    )
    text = said("drive_law", friction_1_N=1.0, share_1=0.1)
    assert "by 3 N at low and 7 N at high tension after each reversal" in text


def test_friction_at_the_drive_that_differs_with_the_speed_is_said():
    text = said("drive_law", friction_1_N=1.0, speed_2=-0.1, speed_3=-0.2)
    assert "; friction changes from 0 to -20 % from 1 to 10 mm/s" in text
    assert "mm/s" not in said("drive_law", friction_1_N=1.0, speed_3=0.02)
    text = said("drive_law", friction_1_N=1.0, place_3=0.3, place_5=-0.2)
    assert "; it changes between -20 and 30 % along the stroke" in text
    assert "stroke" not in said("drive_law", friction_1_N=1.0, place_4=0.02)


def test_a_gap_is_said_where_it_carries_most():
    """Of width travel: a gap as long as the width."""
    text = said("drive_law", travel_mm=4.0, gap_friction_1_N=2.0, friction_1_N=0.5)
    assert "by 5 N after each reversal, within " in text
    assert text.endswith("hardly over a gap of 4 mm in its middle.")
    assert "gap" not in said("drive_law", travel_mm=4.0, gap_friction_1_N=0.5, friction_1_N=2.0)


def test_what_is_small_beside_the_rest_is_left_out():
    curve = dict(
        zip((f"curve_{k}_mm" for k in range(1, 6)), (0.0, 1.0, 2.0, 3.0, 4.0), strict=True)
    )
    text = said("load_law", lost_1_mm=0.01, compliance_mm_per_N=1e-4, **curve)
    # About its mean, which is the zero of x_out.
    assert text.startswith("At the load x_out deviates from -2 to 2 mm along the stroke")
    assert text.endswith(", in a straight line.")
    assert "yields by 0.1 mm per N" in said("load_law", lost_1_mm=0.5, compliance_mm_per_N=0.1)


def test_friction_in_the_sheath_is_said_in_percent():
    text = said("tendon_law", start_1=0.3, speed_2=-0.1, speed_3=0.2)
    assert text.startswith("In the sheath friction differs by 30 % after each reversal")
    assert "friction changes between -10 and 20 % from 1 to 10 mm/s" in text


def test_the_change_after_a_reversal_ends_at_twice_the_weights():
    value = NOTHING["load_law"] | {"lost_1_mm": 0.2, "lost_2_mm": 0.1}
    travel = np.array([0.0, 0.25, 0.5, 2.0, 9.0])  # widths of 1 and 0.25 mm
    expected = [0.0, 0.05 + 0.1, 0.1 + 0.2, 0.6, 0.6]
    assert after_reversal("load_law", value, travel, 0.0) == pytest.approx(expected)
