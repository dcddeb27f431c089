"""Fits of the dynamic model: what a recording shows is found, what it does not is said."""

import math
from types import SimpleNamespace

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals.references import FOLDER, problems
from tests.identification.recorded import ran
from tests.identification.test_odd_recordings import ran as of_the_rig
from tests.identification.test_odd_recordings import recorded as by_the_rig
from tests.physics.references import LOADED_BY_SPRING, TABLE_1, course_of
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.calibration import calibrate_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
from tsas_cli.physics.lugre.chain import OWN_STEPS, StepControl, lugre_chain
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.response import LUMPS
from tsas_cli.physics.rig import with_values
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.support.steps import NO_PROGRESS

SHEET = {
    "friction_coefficient": 0.12,
    "load_stiffness_N_per_mm": 1.5,
    "tendon_diameter_mm": 1.2,
    "tendon_modulus_GPa": 60.0,
}
MODEL = problems()["speeds-50"].model
VISCOUS = "viscous_friction.coefficient_N_s_per_mm"
TRUTH = {
    "friction_coefficient": MODEL.friction_coefficient,
    "load_stiffness_N_per_mm": MODEL.load_stiffness_N_per_mm,
    "tendon_stiffness_N": MODEL.tendon_stiffness_N,
    "bristles.stiffness_N_per_mm": MODEL.bristle_stiffness_N_per_mm,
    "bristles.damping_N_s_per_mm": MODEL.whole_bristle_damping,
    VISCOUS: MODEL.viscous_N_s_per_mm,
    "stribeck_friction.excess": MODEL.stribeck_excess,
    "stribeck_friction.velocity_mm_per_s": MODEL.stribeck_speed_mm_s,
}


def recorded(name, *, noise_N, noise_mm, seed):
    """Return a reference solution, which another solver found, with noise on every channel."""
    table, model = pq.read_table(FOLDER / f"{name}.parquet"), problems()[name].model
    rng = np.random.default_rng(seed)
    columns = {"time_s": table["time_s"].to_numpy()}
    for column in table.column_names[1:]:
        noise = noise_N if column.endswith("_N") else noise_mm
        columns[column] = table[column].to_numpy() + noise * rng.standard_normal(len(table))
    bent = {"sheath_length_mm": model.length_mm, "total_bend_rad": model.total_bend_rad}
    return ran(columns, load="spring", preload_N=25.0, **bent)


def calibrated(run):
    manifest = Manifest(format=1, name="t", kind="simulated", rig=SHEET, run=(run.run,))
    return calibrate_runs(manifest, [run], dynamics="lugre")


def fitted(result):
    return {e.name: e for e in result.model.estimates if e.origin == "fitted"}


@pytest.fixture(scope="module")
def quiet():
    return calibrated(recorded("speeds-50", noise_N=0.003, noise_mm=1e-4, seed=2))


@pytest.fixture(scope="module")
def noisy():
    return calibrated(recorded("speeds-50", noise_N=0.03, noise_mm=2e-3, seed=1))


@pytest.mark.large  # tests/commands/test_calibrate.py finds some of them each time
def test_all_constants_of_friction_are_found_where_they_show(quiet):
    """One of eight intervals of 95 % may just miss."""
    found = fitted(quiet)
    for name, true in TRUTH.items():
        reach = 0.75 * (found[name].interval_high - found[name].interval_low)
        assert found[name].value == pytest.approx(true, abs=reach), name
        assert found[name].value == pytest.approx(true, rel=0.05), name
    assert found["stribeck_friction.excess"].value == pytest.approx(0.1, rel=0.01)
    assert found["stribeck_friction.velocity_mm_per_s"].value == pytest.approx(8.0, rel=0.01)


def test_under_noise_the_bristles_damping_is_not_identifiable_and_the_others_allow_for_it(noisy):
    found = fitted(noisy)
    assert "bristles.damping_N_s_per_mm" not in found
    for name in TRUTH.keys() - {"bristles.damping_N_s_per_mm"}:
        assert found[name].interval_low <= TRUTH[name] <= found[name].interval_high, name
    (said,) = [s for s in noisy.cannot_tell if s.startswith("bristles.damping_N_s_per_mm")]
    assert said.startswith("bristles.damping_N_s_per_mm is not identifiable: 0 to ")
    most = float(said.split("0 to ")[1].split(" ")[0])
    assert 2.0 <= most < 15.0


def test_the_model_that_was_fitted_is_the_one_that_is_compared(noisy):
    (answer,) = noisy.predictions
    assert answer.response.solver.startswith("LuGre chain")
    assert answer.summary.rmse["f_out_N"] == pytest.approx(0.03, rel=0.05)
    assert not any("reduced chi-square" in sentence for sentence in noisy.cannot_tell)


def test_a_stribeck_velocity_far_below_all_speeds_is_not_identifiable():
    """Table 1 of Yang 2025 has 4 % more friction at rest, below 0.01 mm/s at strokes of 10 mm/s."""
    result = calibrated(recorded("a-50", noise_N=0.03, noise_mm=2e-3, seed=1))
    found = fitted(result)
    assert not any(name.startswith("stribeck") for name in found)
    (said,) = [s for s in result.cannot_tell if s.startswith("stribeck_friction.excess")]
    lowest = float(said.split("velocities of ")[1].split(" ")[0])
    assert 0.01 < lowest < 1.0
    for name, true in (("friction_coefficient", 0.125), (VISCOUS, 0.02)):
        assert found[name].interval_low <= true <= found[name].interval_high


def test_a_rig_without_bristles_is_found_to_have_stiff_ones():
    """The rig of the challenge sticks and slips by Coulomb's law, without any bristles."""
    result = calibrated(of_the_rig(by_the_rig()))
    (said,) = [s for s in result.cannot_tell if "fit equally well" in s and "stiffness" in s]
    lowest, highest = (
        float(part.split(" ")[0]) for part in said.split("identifiable: ")[1].split(" to ")
    )
    assert lowest > 8e3
    assert highest > 1e6
    assert result.predictions[0].summary.rmse["f_in_N"] < 0.12  # 0.34 with the bristles of Table 1


def f_in(rig, tolerance=3e-6, step_ends_s=OWN_STEPS):
    time_s = np.arange(0.0, 7.0, 5e-3)
    x_in = 10.0 - 10.0 * np.cos(time_s) + 2.0 * (1.0 - np.cos(3.3 * time_s))
    start = np.zeros((2, 52))
    start[1] = rig.preload_N
    course = course_of(x_in, rig, time_s=time_s)
    control = StepControl(tolerance, step_ends_s)
    output, progress = lugre_chain(course, start, rig, LOADED_BY_SPRING, 50, control, None)
    return output.f_in, progress.step_ends_s


@pytest.mark.parametrize(
    ("name", "within"),
    [
        ("friction_coefficient", 3e-3),
        ("bristles.damping_N_s_per_mm", 4e-2),
        pytest.param("bristles.stiffness_N_per_mm", 1e-2, marks=pytest.mark.large),
        pytest.param(VISCOUS, 5e-3, marks=pytest.mark.large),
        pytest.param("stribeck_friction.excess", 5e-3, marks=pytest.mark.large),
        ("stribeck_friction.velocity_mm_per_s", 1e-2),
    ],
)
def test_with_the_steps_of_another_run_finite_differences_are_derivatives(name, within):
    """Held against central differences at a tolerance that is 3,000 times tighter."""
    values = {n: v for n, v in TRUTH.items() if "." in n}
    rig = with_values(TABLE_1, values)

    def at(change, **how):
        return f_in(with_values(rig, {name: TRUTH[name] * math.exp(change)}), **how)[0]

    exact = (at(1e-3, tolerance=1e-9) - at(-1e-3, tolerance=1e-9)) / 2e-3
    steps = f_in(rig)[1]
    repeated = (at(1e-5, step_ends_s=steps) - at(0.0, step_ends_s=steps)) / 1e-5
    own = (at(1e-5) - at(0.0)) / 1e-5
    size = np.linalg.norm(exact)
    assert np.linalg.norm(repeated - exact) < within * size
    assert np.linalg.norm(own - exact) > 0.2 * size  # why the steps are repeated


SPEED = np.geomspace(0.01, 100.0, 400)  # a hundred samples in each decade
SLOPES = np.column_stack((np.log(SPEED), np.cos(np.arange(400.0))))
OFF = np.array([0.4, -0.2])  # of the free parameters
DAMPED = with_values(TABLE_1, {"bristles.damping_N_s_per_mm": 7.0})


def at_rest(velocity):
    return 10.0 * np.exp(-SPEED / velocity)


def made(monkeypatch, lacks, **known):
    """Return a fit, off by its free parameters and by what it lacks; excesses wear off."""
    residual = SLOPES @ OFF - lacks

    def residuals_with(_, changes):
        excess = changes.get(d.EXCESS, 0.0)
        own = at_rest(changes.get(d.VELOCITY, 1.0)) * excess / (1.0 + 5.0 * excess)
        values = [(changes[n], v) for n, v in known.items() if n in changes]
        return residual + own + sum(np.sin(SPEED) * math.log(at / v) for at, v in values)

    monkeypatch.setattr(d, "residuals_with", residuals_with)
    monkeypatch.setattr(d, "slopes_of_free", lambda _: SLOPES)
    return SimpleNamespace(rigs=[TABLE_1, DAMPED]), float(residual @ residual)


def test_friction_at_rest_is_screened_over_its_velocity(monkeypatch):
    """At the right one nothing is left; a tenth shows where ten deviations of it are its own."""
    fit, squares = made(monkeypatch, 0.3 * at_rest(1.0))
    looks = d._friction_at_rest(fit, NO_PROGRESS)
    best = max(looks, key=lambda look: look.saves)
    assert best.values[d.VELOCITY] == pytest.approx(1.0)
    assert best.values[d.EXCESS] == pytest.approx(0.3, rel=0.01)
    assert best.moves == pytest.approx(-OFF, abs=1e-6)
    assert best.saves == pytest.approx(squares)
    beside = np.eye(400) - SLOPES @ np.linalg.pinv(SLOPES)
    shown = [0.1 / 1.5 * np.linalg.norm(beside @ at_rest(v)) > 10.0 for v in d.VELOCITIES]
    assert [look.shows for look in looks] == shown
    assert 3 < sum(shown) < 14
    said = d._static_friction_note(looks)
    ends = d.VELOCITIES[shown][[0, -1]]
    assert f"10% more friction at rest would be visible for velocities of {ends[0]:.2g} to " in said
    assert f" to {ends[1]:.3g} mm/s;" in said
    assert d._static_friction_note(looks[:1]).endswith("recordings, whatever their values.")


@pytest.mark.parametrize(("lacks", "begins"), [(-0.3, 0.01), (5.0, 1.0)])
def test_friction_at_rest_begins_within_its_range_and_is_never_less(monkeypatch, lacks, begins):
    fit, _ = made(monkeypatch, lacks * at_rest(1.0))
    looks = d._friction_at_rest(fit, NO_PROGRESS)
    assert looks[8].values == pytest.approx({d.EXCESS: begins, d.VELOCITY: 1.0})
    assert (looks[8].saves == 0.0) == (lacks < 0.0)


@pytest.mark.parametrize(
    ("name", "usual", "true"),
    [
        (d.STIFFNESS, TABLE_1.bristles.stiffness_N_per_mm, 0.05),
        (d.DAMPING, max(7.0, bristles_of(TABLE_1).damping), 5.0),
        (VISCOUS, 0.02, 100.0),
    ],
)
def test_a_fixed_value_is_screened_from_its_usual_one(monkeypatch, name, usual, true):
    lacks = np.sin(SPEED) * math.log(true)
    fit, squares = made(monkeypatch, lacks, **{name: usual})
    looks = d._sizes(fit, name, NO_PROGRESS)
    tried = np.array([look.values[name] for look in looks]) / usual
    times = [t * 10.0**k for k in range(3) for t in (1.0, 2.0, 5.0)][:7]
    below = [1.0 / t for t in times] if name == d.STIFFNESS else []
    assert tried == pytest.approx([*times, *below])
    best = max(looks, key=lambda look: look.saves)
    assert best.values[name] == pytest.approx(true * usual)
    assert best.moves == pytest.approx(-OFF)
    assert best.saves == pytest.approx(squares)
    note = d._indistinguishable_note(name, looks[:3])
    lowest = f"{usual:.2g}" if name == d.STIFFNESS else "0"
    assert f"{name} is not identifiable: {lowest} to {5.0 * usual:.2g} N" in note


def test_errors_hold_the_moves_of_all_values_that_fit_as_well():
    """A standard error of 3 and a move of 8 over a t of 2 are 5."""
    none = np.zeros(2, dtype=bool)
    fitted = Fitted(np.zeros(2), np.array([3.0, 1.0]), np.array([2.0, 2.0]), none, True, "", 1)
    looks = [d.ScreenedValue({}, np.array(moves), 0.0) for moves in ((1.0, 0.0), (-8.0, 0.0))]
    assert d._widened(fitted, looks).stderr == pytest.approx([5.0, 1.0])


def freed(monkeypatch, saves=26.0, **changed):
    """Return whether a damping is freed that is found at 3 [1, 9]."""
    found = {"stderr": 1.0, "interval_low": 1.0, "interval_high": 9.0} | changed
    estimate = Estimate(d.DAMPING, 3.0, "N s/mm", "fitted", **found)
    more = SimpleNamespace(model=Model((estimate,)))
    monkeypatch.setattr(d, "_solved_again", lambda *_: more)
    fit = SimpleNamespace(problem=SimpleNamespace(fixed=Model(()), unknowns=[]))
    looks = [d.ScreenedValue({d.DAMPING: v}, OFF, s) for v, s in ((1.0, 0.0), (2.0, saves))]
    return d._freed(fit, looks, NO_PROGRESS) is more


def test_a_value_is_freed_that_saves_much_and_is_found_within_its_bounds(monkeypatch):
    assert freed(monkeypatch)
    for how in (
        *({"saves": 24.0}, {"stderr": None}, {"interval_low": None}, {"at_bound": True}),
        {"interval_low": 1e-6},
    ):
        assert not freed(monkeypatch, **how)


@pytest.mark.parametrize(
    ("low", "value", "high", "at"),
    [
        (1.0, 5.0, 99.0, None),
        (1.0, 5.0, 101.0, 5.0),  # an interval that tells nothing
        (0.9, 1.0, 1.1, "finest"),
        (None, 5.0, 99.0, None),
    ],
)
def test_a_stiffness_is_fixed_where_it_is_vague_or_bends_within_a_lump(
    monkeypatch, low, value, high, at
):
    """With the finest one √(EA L/σ0) is the length of a lump."""
    finest = d._finest_stiffness(SimpleNamespace(rigs=[TABLE_1]))
    L = TABLE_1.sheath_length_mm
    assert math.sqrt(TABLE_1.tendon_stiffness_N * L / finest) == pytest.approx(L / LUMPS)
    unit = 1.01 * finest if at == "finest" else 1e-3 * finest
    low, value, high = (None if v is None else unit * v for v in (low, value, high))
    e = Estimate(d.STIFFNESS, value, "N/mm", "fitted", None, 1.0, low, high)
    unknowns = [SimpleNamespace(name=n) for n in ("preload_N", d.STIFFNESS, VISCOUS)]
    fit = SimpleNamespace(
        rigs=[TABLE_1],
        model=Model((e,)),
        chosen=(0, 1),
        problem=SimpleNamespace(fixed=Model(()), unknowns=unknowns),
    )
    monkeypatch.setattr(d, "_solved_again", lambda fit, look, fixed, further, _: (fixed, further))
    found = d._at_stiffness(fit, NO_PROGRESS)
    if at is None:
        assert found is None
    else:
        fixed, further = found
        expected = finest if at == "finest" else unit * at
        assert fixed.value(d.STIFFNESS, None) == pytest.approx(expected)
        assert further == [VISCOUS]
