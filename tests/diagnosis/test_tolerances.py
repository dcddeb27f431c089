"""What every rig has by a small amount, on linear fits to data that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.diagnosis.friction_scatter import is_in_line, is_scatter, within_scatter
from tsas_cli.diagnosis.held_out import folds_of, held_out_squares
from tsas_cli.diagnosis.tolerances import (
    _of_sensors,
    moved_by_tolerances,
    of_others,
    scale_is_tolerated,
    tolerances,
    with_scale_and_zeros,
    with_tolerances,
    within_tolerances,
    without_tolerances,
    zeros_are_tolerated,
)
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.physics.rig import with_values

RUNS, ROWS = 4, 500
RUN = np.repeat(np.arange(RUNS), ROWS)
RNG = np.random.default_rng(8)
FRICTION = 50.0 * RNG.standard_normal(RUN.size)  # residuals by a relative change of the friction
OTHER = RNG.standard_normal(RUN.size)
NONE = np.zeros((RUN.size, 0))
DRIFT = "friction_drift.session_rate_per_s"


def fit(errors, *columns):
    """Return the fit of the friction and of further columns, by name, to errors plus noise."""
    J = np.column_stack([FRICTION, *(column for _, column in columns)])
    data = errors + np.random.default_rng(9).standard_normal(RUN.size)
    values = np.linalg.lstsq(J, data, rcond=None)[0]
    names = ["friction_coefficient", *(name for name, _ in columns)]
    unknowns = tuple(Unknown(name, None, 0.0, -1e6, 1e6, 1.0) for name in names)
    solution = Solution(values, np.zeros(values.size, bool), J @ values - data, J, True, "", 1)
    return HypothesisFit((), unknowns, solution, (ROWS,) * RUNS, on_mesh=False)


@pytest.mark.parametrize(("scatter", "left"), [(0.02, 0.05), (0.2, 0.3)])
def test_a_plausible_scatter_is_left_out_of_the_residual_and_a_large_one_less(scatter, left):
    """Of four runs two have more friction and two less; the mean is fitted."""
    per_run = scatter * np.array([1.0, -1.0, 1.0, -1.0])[RUN]
    trial = fit(FRICTION * per_run)
    before = float(np.mean(trial.solution.residual**2)) - 1.0
    after = float(np.mean(without_tolerances(trial, NONE, RUN) ** 2)) - 1.0
    assert before == pytest.approx((50.0 * scatter) ** 2, rel=0.2)
    assert abs(after) < left * max(before, 1.0)


@pytest.mark.parametrize(
    ("frictions", "starts_s", "in_line"),
    [
        ((0.0, 0.01, 0.02, 0.03), (0.0, 300.0, 600.0, 900.0), True),
        ((0.0, 0.01, 0.02, 0.03), (0.0, 900.0, 300.0, 600.0), False),
        ((0.01, -0.01, 0.02, -0.02), (0.0, 300.0, 600.0, 900.0), False),
        ((0.0, 0.01, 0.02, 0.03), (0.0, 0.0, 0.0, 0.0), False),
        ((0.0, 0.0, 0.0, 0.04), (0.2, 0.2, 0.2, 0.4), False),  # one run alone
        ((0.0, 0.0, 0.04, 0.04), (0.2, 0.2, 0.4, 0.4), True),
    ],
)
def test_frictions_that_change_with_the_session_are_no_scatter(frictions, starts_s, in_line):
    trial = fit(FRICTION * np.array(frictions)[RUN])
    assert is_in_line(trial, RUN, np.array(starts_s)) == in_line


@pytest.mark.parametrize(("size", "left"), [(1.5, 0.02), (6.0, 16.0)])
def test_a_hypothesis_predicts_with_tolerances_beside_it_up_to_two_deviations(size, left):
    """One deviation of the tolerance is one of the noise: (6 − 2)² stay of six deviations."""
    folds = folds_of([np.arange(ROWS) // 25] * RUNS)
    trial = fit(size * OTHER)
    squares = held_out_squares(with_tolerances(trial, -OTHER[:, None]), folds).sum() / RUN.size
    alone = held_out_squares(trial, folds).sum() / RUN.size
    assert alone == pytest.approx(1.0 + float(np.mean((size * OTHER) ** 2)), rel=0.05)
    assert squares == pytest.approx(1.0 + left * float(np.mean(OTHER**2)), rel=0.05)


def test_what_no_friction_explains_stays():
    trial = fit(3.0 * np.sign(OTHER))
    left = without_tolerances(trial, NONE, RUN)
    assert float(left @ left) > 0.98 * float(trial.solution.residual @ trial.solution.residual)


def test_a_column_of_one_friction_for_each_run_is_scatter():
    trial = fit(np.zeros(RUN.size))
    assert is_scatter(trial, FRICTION * RUN, RUN)
    assert not is_scatter(trial, OTHER, RUN)
    assert not is_scatter(trial, FRICTION * np.linspace(-1.0, 1.0, RUN.size) ** 3, RUN * 0)


@pytest.mark.parametrize(
    ("frictions", "within"),
    [
        ([0.013, 0.009, -0.004, -0.015], True),  # nearly in order, by chance
        ([-0.03, 0.04, -0.03, 0.04], True),
        ([-0.3, 0.4, -0.3, 0.4], False),  # more than is plausible
        ([-0.02, -0.0067, 0.0067, 0.02], False),  # in line
        ([-0.12, -0.04, 0.05, 0.13], False),
    ],
)
def test_a_drift_from_run_to_run_is_scatter_where_it_is_small_and_not_in_line(frictions, within):
    trial = fit(FRICTION * np.array(frictions)[RUN], (DRIFT, FRICTION * RUN))
    assert within_scatter(trial, "friction_drift", RUN) == within


def test_two_runs_tell_no_drift_from_scatter():
    two = RUN // 2
    trial = fit(FRICTION * 0.01 * two, (DRIFT, FRICTION * two))
    assert within_scatter(trial, "friction_drift", two)


def test_a_drift_within_the_runs_is_no_scatter():
    course = RUN + np.sin(np.arange(RUN.size) / 50.0)
    trial = fit(FRICTION * 0.005 * course, (DRIFT, FRICTION * course))
    assert not within_scatter(trial, "friction_drift", RUN)


CELL = 10.0 * RNG.standard_normal(RUN.size)  # residuals by one standard deviation of a load cell
CROSSTALK = "force_crosstalk.f_in_of_f_out"


@pytest.mark.parametrize(("amount", "left"), [(1.0, 0.0), (-1.9, 0.0), (5.0, 3.0), (-5.0, 3.0)])
def test_a_load_cell_is_left_out_as_far_as_it_is_plausible(amount, left):
    """Two standard deviations; each is ten times the noise."""
    residual = without_tolerances(fit(amount * CELL), CELL[:, None], RUN)
    assert float(np.mean(residual**2)) == pytest.approx(1.0 + (10.0 * left) ** 2, rel=0.1)


def test_what_a_free_parameter_does_is_not_left_out_for_a_second_time():
    """A tolerance that the friction imitates takes nothing away, and moves no residual."""
    trial = fit(3.0 * np.sign(OTHER))
    residual = without_tolerances(trial, FRICTION[:, None], RUN * 0)
    assert residual == pytest.approx(trial.solution.residual, abs=1e-6)


@pytest.mark.parametrize(("amount", "within"), [(1.0, True), (1.9, True), (2.2, False)])
def test_an_effect_that_does_what_a_plausible_load_cell_does_is_within_tolerances(amount, within):
    trial = fit(amount * CELL, (CROSSTALK, CELL))
    assert within_tolerances(trial, "force_crosstalk", CELL[:, None], 0.0) == within


@pytest.mark.parametrize(
    ("parameter", "rate", "tolerated"),
    [
        ("f_in_session_rate_N_per_s", -1.9e-4, True),
        ("f_in_session_rate_N_per_s", -2.1e-4, False),
        ("f_in_rate_N_per_s", 0.0099, True),
        ("f_in_rate_N_per_s", 0.0101, False),
        ("f_out_rate_N_per_s", 1.0, True),  # nobody reads that sensor
    ],
)
def test_a_zero_that_moves_by_four_thousandths_of_the_largest_force_is_a_tolerance(
    parameter, rate, tolerated
):
    """0.2 N of 50 N, after 1000 s of the session or in 20 s of a run."""
    forces = {"f_in_N": np.array([-50.0, 20.0])}
    recorded = SimpleNamespace(measured=forces, session_s=1000.0, time_s=np.array([3.0, 23.0]))
    run = SimpleNamespace(run=recorded, samples={"f_in_N": np.array([0, 1])})
    rig = with_values(GROUP_A, {f"force_sensor_drift.{parameter}": rate})
    bench = SimpleNamespace(closed=[run], channels=("f_in_N",), rig=lambda trial, k: rig)
    assert zeros_are_tolerated(bench, None) == tolerated


def test_an_effect_of_another_shape_is_not_within_tolerances():
    """More than half of its squares are none of a load cell's."""
    trial = fit(CELL + 12.0 * OTHER, (CROSSTALK, CELL + 12.0 * OTHER))
    assert not within_tolerances(trial, "force_crosstalk", CELL[:, None], 0.0)
    trial = fit(CELL + 8.0 * OTHER, (CROSSTALK, CELL + 8.0 * OTHER))
    assert within_tolerances(trial, "force_crosstalk", CELL[:, None], 0.0)


def test_tolerances_are_a_quarter_of_a_percent_of_the_largest_reading_beside_what_is_fitted():
    """A linear bench, of which each parameter changes one residual.

    Of what only the chain has, three micrometres of elastic travel and two modes of the bend do.
    """
    at = {
        "force_sensor_gain.f_out_gain": 0,
        "force_crosstalk.f_in_of_f_out": 1,
        "force_crosstalk.f_out_of_f_in": 2,
        "force_sensor_curvature.f_in_per_N": 3,
        "force_sensor_curvature.f_out_per_N": 4,
    }
    fitted = {"force_crosstalk.f_in_of_f_out": 0.04, "presliding.length_mm": 0.03}
    neutral = {"force_sensor_gain.f_out_gain": 1.0}

    def errors_at(trial, changes):
        out = np.zeros(5)
        for name, row in at.items():
            out[row] = (neutral | fitted | changes).get(name, 0.0)
        return out

    def changes_on_chain(trial, settings):
        assert settings == [
            {"presliding.length_mm": 0.033},
            {"bend_slope": 0.05},
            {"bend_bow": 0.05},
        ]
        return np.full((5, 3), 7.0)

    # What is not compared, as between the samples of a slower clock, is no reading.
    measured = {"f_in_N": np.array([3.0, np.nan, -50.0]), "f_out_N": np.array([20.0, 5.0, 900.0])}
    samples = {"f_in_N": np.array([0, 2]), "f_out_N": np.array([0, 1])}
    run = SimpleNamespace(samples=samples, run=SimpleNamespace(measured=measured))
    bench = SimpleNamespace(
        channels=["f_in_N", "f_out_N", "x_out_mm"],
        closed=[run],
        errors_at=errors_at,
        changes_on_chain=changes_on_chain,
    )
    columns = tolerances(bench, SimpleNamespace(values=lambda: fitted))
    sizes = [0.0025, 0.0025, 0.0025, 0.0025 / 50.0, 0.0025 / 20.0]
    assert columns[:, :5] == pytest.approx(np.diag(sizes))
    assert np.all(columns[:, 5:] == 7.0)


class Reads:
    """A run that reads forces of up to 50 and 20 N; a residual is an error over 0.1 of a unit."""

    def __init__(self, *channels):
        self.samples = {name: np.arange(3) for name in channels}
        measured = {"f_in_N": np.array([3.0, 8.0, -50.0]), "f_out_N": np.array([20.0, 5.0, 1.0])}
        self.run = SimpleNamespace(measured=measured, time_s=np.arange(3.0))
        self.count = 3 * len(channels)

    def predict(self, rig):
        return {"x_out_mm": np.array([0.0, 100.0, 300.0])}

    def changed(self, changes):
        return np.concatenate([changes.get(n, np.zeros(3)) / 0.1 for n in self.samples])


def reading(*runs):
    return SimpleNamespace(
        errors_for=lambda trial: runs,
        rig=lambda trial, k: None,
        rigs=[None] * len(runs),
        closed=runs,
        channels=["f_in_N", "f_out_N", "x_out_mm"],
    )


def test_each_run_has_zeros_of_its_own_and_all_have_one_scale():
    """Zeros of 0.1 and 0.04 N are one and 0.4 residuals; a thousandth of 100 mm is one."""
    runs = Reads("f_in_N", "f_out_N"), Reads("f_in_N", "x_out_mm")
    columns = with_scale_and_zeros(reading(*runs), None, np.full((12, 1), 7.0))
    further = np.zeros((12, 5))
    further[9:, 0] = 0.0, 1.0, 3.0
    further[:3, 1], further[3:6, 2], further[6:9, 3] = 1.0, 0.4, 1.0
    assert columns == pytest.approx(np.column_stack((np.full(12, 7.0), further)))
    alone = with_scale_and_zeros(reading(runs[1]), None, np.zeros((6, 0)))
    assert alone == pytest.approx(further[6:, :1])  # the zeros of one run alone are fitted


@pytest.mark.parametrize(("gain", "tolerated"), [(1.0019, True), (0.9981, True), (1.0021, False)])
def test_a_scale_of_x_out_within_two_thousandths_is_a_tolerance(gain, tolerated):
    trial = SimpleNamespace(values=lambda: {"position_sensor_gain.x_out_gain": gain})
    assert scale_is_tolerated(trial) == tolerated


def test_the_rig_of_each_run_is_moved_by_what_its_residuals_show():
    """The second run reads 0.05 N more of f_in; x_out reads a thousandth less in both."""
    rig = with_values(GROUP_A, {"force_sensor_offset.f_in_offset_N": 0.3})
    moved = [
        with_values(rig, _of_sensors(rig, -1.0, {"f_in_N": 0.1}, np.array([amount])))
        for amount in (0.0, 0.5)
    ]
    offsets = [one.effects.force_sensor_offset.f_in_offset_N for one in moved]
    assert offsets == pytest.approx([0.3, 0.35])
    gains = [one.effects.position_sensor_gain.x_out_gain for one in moved]
    assert gains == pytest.approx([0.999, 0.999])


def test_an_effect_that_is_named_has_no_tolerance_of_its_own():
    given = np.arange(16.0).reshape(2, 8) + 1.0
    others = of_others(SimpleNamespace(effects=("force_crosstalk",)), given)
    assert others.tolist() == [[1, 0, 0, 4, 5, 6, 7, 8], [9, 0, 0, 12, 13, 14, 15, 16]]
    assert given[0, 1] == 2.0
    others = of_others(SimpleNamespace(effects=("presliding",)), given)
    assert np.flatnonzero(others[0] == 0.0).tolist() == [5]
    assert of_others(SimpleNamespace(effects=()), given).tolist() == given.tolist()


def test_what_takes_away_more_than_it_changes_beside_the_others_is_not_within_tolerances():
    """A sheath's compliance and the tendon's do the same until one of them is at its bound."""
    trial = fit(CELL, (CROSSTALK, CELL))
    squares = float(CELL @ CELL)
    assert within_tolerances(trial, "force_crosstalk", CELL[:, None], squares)
    assert not within_tolerances(trial, "force_crosstalk", CELL[:, None], 10.0 * squares)


BLOCKS = [np.arange(ROWS) // 25 for _ in range(RUNS)]
X = np.tile(np.linspace(-1.0, 1.0, ROWS), RUNS)
LINE = X[:, None]
WAVE = np.cos(40.0 * X)  # what no slope can imitate


def unsure(signature, truly=0.0):
    """Fit a slope to noise and to so much of the first way; the second does nothing."""
    data = np.random.default_rng(1).standard_normal(X.size) + truly * signature
    slope = np.linalg.lstsq(LINE, data, rcond=None)[0]
    solution = Solution(slope, np.zeros(1, bool), LINE @ slope - data, LINE, True, "", 1)
    trial = HypothesisFit(
        (), (Unknown("slope", None, 0.0, -9.0, 9.0, 1.0),), solution, (ROWS,) * RUNS, on_mesh=False
    )
    ways = np.column_stack((signature, np.zeros(X.size)))
    (moved,), ((unsure,),) = moved_by_tolerances(trial, -ways, BLOCKS)
    return float(slope[0]), float(moved), float(np.sqrt(unsure))


def test_what_looks_like_a_parameter_leaves_it_as_unsure_as_is_plausible():
    _, moved, found = unsure(0.3 * X)
    assert moved == pytest.approx(0.0, abs=0.02)
    assert found == pytest.approx(0.3, rel=0.05)


def test_what_the_recordings_rule_out_leaves_nothing_unsure():
    _, moved, found = unsure(0.3 * X + 5.0 * WAVE)
    assert abs(moved) < 0.02
    assert found < 0.02


@pytest.mark.parametrize("truly", [-2.0, 1.0, 2.0])
def test_what_the_recordings_ask_for_is_taken_back(truly):
    slope, moved, found = unsure(0.3 * X + 5.0 * WAVE, truly)
    assert abs(slope) > 0.9 * abs(0.3 * truly)
    assert slope + moved == pytest.approx(0.0, abs=0.05)
    assert found < 0.02


def test_no_tolerance_counts_for_more_than_is_plausible():
    """The slope is off by ten times what two standard deviations do."""
    slope, moved, _ = unsure(0.3 * X + 5.0 * WAVE, 20.0)
    assert abs(slope) == pytest.approx(6.0, abs=0.1)
    assert abs(moved) == pytest.approx(0.3 * 2.0, rel=0.05)
