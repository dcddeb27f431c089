"""Fits of the dynamic model: what a recording shows is found, what it does not is said."""

import math

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals.references import FOLDER, problems
from tests.identification.recorded import ran
from tests.identification.test_odd_recordings import ran as of_the_rig
from tests.identification.test_odd_recordings import recorded as by_the_rig
from tests.physics.references import LOADED_BY_SPRING, TABLE_1, course_of
from tsas_cli.identification.calibration import calibrate_runs
from tsas_cli.physics.lugre.chain import OWN_STEPS, StepControl, lugre_chain
from tsas_cli.physics.rig import with_values
from tsas_cli.recordings.manifest import Manifest

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
    output, progress = lugre_chain(course, start, rig, LOADED_BY_SPRING, 50, control)
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
