"""Each fault of a recording is told by its own law, on two short runs that are made up."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.faults import search as s
from tsas_cli.diagnosis.faults import shapes
from tsas_cli.diagnosis.faults.beside import Candidate, beside, one
from tsas_cli.diagnosis.faults.candidates import candidates
from tsas_cli.diagnosis.faults.shapes import passed, runs_at
from tsas_cli.diagnosis.faults.words import differing
from tsas_cli.diagnosis.friction_scatter import frictions_that_explain
from tsas_cli.diagnosis.tolerances import frictions_of
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.recordings.manifest import Run

F, X, DRIVE = "f_out_N", "x_out_mm", "x_in_mm"
N = 240
T = 0.05 * np.arange(N)  # 24 parts of 0.5 s
SD = {F: 0.5, X: 0.1}
BY_DRIVE = {F: 3.0, X: 0.5}  # what each channel does by 1 mm of the drive
RUN = np.repeat((0, 1), 2 * N)
RNG = np.random.default_rng(3)
JACOBIAN = 100.0 * RNG.standard_normal((RUN.size, 4))
TOLERATED = RNG.standard_normal((RUN.size, 2))
NOISE = RNG.standard_normal(RUN.size)
NAMES = ("friction_coefficient", "tendon_stiffness_N", "slack_mm", "still")
JACOBIAN[:, 3] = 0.0  # it changes nothing


def motion(k, t=T):
    return 4.0 * np.sin((1.0 + 0.3 * k) * t + k) + np.cos(2.3 * t)


def values_of(k, name, t=T):
    x = motion(k, t)
    return 50.0 + 3.0 * x + 0.4 * x**2 if name == F else 0.5 * x - 0.01 * x**3


class Errors:
    """A run of which each sample is a residual: predicted less measured, over SD."""

    def __init__(self, k, trial):
        self.k, self.simulation, self.trial = k, k, trial
        self.samples = dict.fromkeys(SD, np.arange(N))
        reversals = np.array([0, 80, 160, N - 1])
        drive = SimpleNamespace(values=motion(k), noise=0.01, reversals=reversals)
        self.run = SimpleNamespace(time_s=5.0 + T, drive_column=DRIVE, conditioned={DRIVE: drive})

    def predict(self, rig):
        return {name: values_of(self.k, name) for name in SD} | {"f_in_N": motion(self.k)}

    def weighted(self, predicted):
        own = self.trial.solution.residual[self.k == RUN]
        return dict(zip(SD, np.split(own, len(SD)), strict=True))

    def changed(self, changes):
        return np.concatenate([changes.get(n, np.zeros(N)) / sd for n, sd in SD.items()])


STIFFNESS_N = 500.0


def errors_at(trial, changes):
    (stiffness,) = changes.values() or (STIFFNESS_N,)
    return NOISE + np.log(stiffness / STIFFNESS_N) * JACOBIAN[:, NAMES.index("tendon_stiffness_N")]


BENCH = SimpleNamespace(
    errors_for=lambda trial: (Errors(0, trial), Errors(1, trial)),
    rig=lambda trial, k: SimpleNamespace(tendon_stiffness_N=STIFFNESS_N),
    errors_at=errors_at,
    rigs=(SimpleNamespace(total_bend_rad=1.0), SimpleNamespace(total_bend_rad=2.0)),
    channels=list(SD),
)


@pytest.fixture(autouse=True)
def driven(monkeypatch):
    """Let what is predicted follow the drive, by a straight line."""

    def predict(k, rig, values):
        moved = values - motion(k)
        return {n: values_of(k, n) + BY_DRIVE[n] * moved for n in SD}

    monkeypatch.setattr(shapes, "predict_driven", predict)


def trial_of(residual, names=NAMES, bound=(2,)):
    unknowns = tuple(Unknown(name, None, 0.0, -1e6, 1e6, 1.0) for name in names)
    at_bound = np.isin(np.arange(4), bound)
    solution = Solution(np.zeros(4), at_bound, residual, JACOBIAN, True, "", 1)
    return HypothesisFit((), unknowns, solution, (2 * N,) * 2, on_mesh=False)


def read_wrongly(readings):
    """Return the residuals where channels of runs read so much more."""
    none = np.zeros(N)

    def of(k, name):
        moved = BY_DRIVE[name] * readings.get((k, DRIVE), none)
        return (moved - readings.get((k, name), none)) / SD[name]

    return np.concatenate([of(k, name) for k in (0, 1) for name in SD])


def speed(k, name):
    h = 1e-6
    return (values_of(k, name, T + h) - values_of(k, name, T - h)) / (2.0 * h)


def late(k, name, late_s):
    return np.interp(T - late_s, T, values_of(k, name)) - values_of(k, name)


def behind_low_pass(k, name, constant_s):
    """Return how much more is read behind a low pass that is at rest at first, in fine steps."""
    fine = 100
    inputs = values_of(k, name, T[0] + 0.05 / fine * np.arange(fine * (N - 1) + 1))
    decay, readings = np.exp(-0.05 / fine / constant_s), [inputs[0]]
    for value in 0.5 * (inputs[1:] + inputs[:-1]):
        readings.append(value + decay * (readings[-1] - value))
    return np.array(readings[::fine]) - values_of(k, name)


def paced(k, name, rate):
    """Return how much more a channel reads whose clock runs late by a share of the time."""
    return np.interp((1.0 + rate) * T, T, values_of(k, name)) - values_of(k, name)


MIDDLE = (T > 1.49) & (T < 4.49)
LEVEL = float(np.quantile([values_of(0, F), values_of(1, F)], 0.4 + 0.58 * 9 / 15))
PASSED = {(k, F): passed(T, values_of(k, F), 5.0) - values_of(k, F) for k in (0, 1)}
HELD = {(k, F): -0.5 * np.maximum(values_of(k, F) - LEVEL, 0.0) for k in (0, 1)}
LAWS = {
    ("run-offset", 1, (F,), -2.0, 0, None, None): {(1, F): np.full(N, -2.0)},
    ("run-offset", 0, (X,), 0.3, 1, 3.5, None): {(0, X): 0.3 * (T > 3.49)},
    ("run-offset", 1, (X,), 0.3, 1, None, 2.5): {(1, X): 0.3 * (T < 2.49)},
    ("run-gain", 1, (F,), 0.1, 2, 1.5, 4.5): {(1, F): 0.1 * values_of(1, F) * MIDDLE},
    ("run-gain", 0, (DRIVE,), 0.05, 1, 6.0, None): {(0, DRIVE): 0.05 * motion(0) * (T > 5.99)},
    ("run-delay", 0, (F,), 0.16): {(0, F): late(0, F, 0.16)},
    ("run-delay", 1, (F, X), -0.04): {(1, n): late(1, n, -0.04) for n in SD},
    ("run-lag", 1, (X,), 0.08): {(1, X): behind_low_pass(1, X, 0.08)},
    ("lost-samples", 0, (F,), -0.32, 1, 5.0, None): {(0, F): late(0, F, -0.32) * (T > 4.99)},
    ("repeated-buffer", 1, (X,), 0.08, 1, 2.5, None): {(1, X): late(1, X, 0.08) * (T > 2.49)},
    ("channel_delay", None, (F,), 0.03): {(k, F): -0.03 * speed(k, F) for k in (0, 1)},
    ("clock", 0, (X,), 4e-4): {(0, X): 4e-4 * T * np.gradient(values_of(0, X), T)},
    ("clock", 1, (X,), 0.004): {(1, X): paced(1, X, 0.004)},
    ("clock", None, (F, X), -0.005): {(k, n): paced(k, n, -0.005) for k in (0, 1) for n in SD},
    ("ac-coupled", None, (F,), 5.0): PASSED,
    ("saturates", None, (F,), LEVEL): HELD,
    ("hum", None, (F,), 1.5): {(k, F): np.sin(2.0 * np.pi * 1.5 * T + k) for k in (0, 1)},
}
# By a frequency, a slope, and lines between samples.
ROUGH = {"hum": 0.1, "channel_delay": 2e-3, "run-lag": 1e-4}


@pytest.mark.parametrize("law", LAWS)
def test_a_fault_explains_all_that_it_does_and_its_amount_is_told(law):
    trial = trial_of(read_wrongly(LAWS[law]) + 2e-3 * JACOBIAN[:, 0])
    left = beside(trial, TOLERATED, RUN)
    best = candidates(BENCH, trial, runs_at(BENCH, trial), left)[0]
    assert (best.code, best.run, best.channels) == law[:3]
    assert best.amount == pytest.approx(law[3], rel=0.02)
    edges, first_s, last_s = law[4:] or (0, None, None)
    assert best.edges == edges
    assert (best.first_s, best.last_s) == pytest.approx((first_s, last_s))
    assert best.reduction == pytest.approx(left.squares, rel=ROUGH.get(best.code, 1e-6))


def test_a_length_of_one_run_is_its_stiffness():
    """Stiffer by a tenth than the model, that yields too much there; or softer in the other one."""
    trial = trial_of(-0.1 * JACOBIAN[:, 1] * (RUN == 1))
    left = beside(trial, TOLERATED, RUN)
    best = candidates(BENCH, trial, runs_at(BENCH, trial), left)[0]
    assert (best.code, best.channels) == ("run-length", ())
    assert best.amount == pytest.approx(0.1 if best.run else -0.1)
    assert best.reduction == pytest.approx(left.squares)


@pytest.mark.parametrize("name", ["slack_mm", "tendon_stiffness_N"])
def test_a_stiffness_that_is_not_free_is_told_by_a_difference_and_none_at_a_bound(name):
    names = (NAMES[0], name, NAMES[2], NAMES[3])
    trial = trial_of(-0.1 * JACOBIAN[:, 1] * (RUN == 1), names, (1, 2))
    left = beside(trial, TOLERATED, RUN)
    best = candidates(BENCH, trial, runs_at(BENCH, trial), left)
    lengths = [(c.run, c.amount) for c in best if c.code == "run-length"][:1]
    assert lengths == ([] if name == NAMES[1] else [(1, pytest.approx(0.1))])


@pytest.mark.parametrize("alike", [False, True])
def test_what_is_left_is_beside_the_free_parameters_and_the_tolerances(alike):
    """Least squares of the residual, with one more row for each tolerance: its amount."""
    trial = trial_of(30.0 * NOISE + JACOBIAN @ (0.1, 0.2, 0.3, 0.4))
    frictions = 0.02 * JACOBIAN[:, [0]] * (RUN[:, None] == (0, 1))
    own = np.column_stack((frictions[:, : 0 if alike else 2], TOLERATED))
    m = own.shape[1]
    above = np.column_stack((JACOBIAN[:, :2], own))
    A = np.vstack((above, np.column_stack((np.zeros((m, 2)), np.eye(m)))))

    def least(A):
        b = np.append(trial.solution.residual, np.zeros(m))
        return b - A @ np.linalg.lstsq(A, b, rcond=None)[0]

    left = beside(trial, TOLERATED, RUN, alike=alike)
    np.testing.assert_allclose(left.residual, least(A), atol=1e-9)
    assert left.squares == pytest.approx(float(least(A) @ least(A)))
    column = RNG.standard_normal(RUN.size) * (RUN == 1)
    further = least(np.column_stack((A, np.append(column, np.zeros(m)))))
    beside_it = left.without(1, column[RUN == 1])
    np.testing.assert_allclose(beside_it.residual, further, atol=1e-9)
    np.testing.assert_allclose(beside_it.seen(column[:, None])[0], 0.0, atol=1e-9)


def test_products_beside_the_basis_are_those_of_what_least_squares_leave_of_columns():
    """A column of one run has the same by its rows alone; the basis itself has none."""
    trial = trial_of(30.0 * NOISE)
    left = beside(trial, TOLERATED, RUN, alike=True)
    columns = RNG.standard_normal((RUN.size, 2)) * (RUN == 1)[:, None]
    own = np.vstack((columns, np.zeros((left.basis.shape[0] - RUN.size, 2))))
    own = own - left.basis @ np.linalg.lstsq(left.basis, own, rcond=None)[0]
    for products, along in (left.seen(columns), left.in_run(1).seen(columns[RUN == 1])):
        np.testing.assert_allclose(products, own.T @ own, rtol=1e-9)
        np.testing.assert_allclose(along, own.T @ left.residual, rtol=1e-9)
    assert not list(one("run-offset", None, (), trial.solution.jacobian[:, 0], left))
    assert len(list(one("run-offset", None, (), columns[:, 0], left))) == 1


def test_an_amplifier_coupled_to_ac_forgets_the_level_and_passes_on_the_slope():
    """By e^(−t/τ) the level; of a slope a that lasts, a τ remains."""
    since = np.maximum(T - 4.0, 0.0)
    expected = np.exp(-T / 2.0) + 3.0 * 2.0 * (1.0 - np.exp(-since / 2.0))
    np.testing.assert_allclose(passed(T, 1.0 + 3.0 * since, 2.0), expected, atol=1e-12)


def search_of(residual, run=RUN):
    return SimpleNamespace(
        bench=BENCH,
        trial=lambda names: trial_of(residual),
        folds=SimpleNamespace(run=run),
        tolerated={False: TOLERATED},
    )


def told(readings, *accepted):
    return s.fault_of_recording(search_of(read_wrongly(readings) + NOISE), accepted)


def test_the_ends_of_a_fault_are_found_between_the_parts():
    reads = 0.8 * ((T > 3.63) & (T < 7.14))
    found = told({(1, X): reads})
    best = found.found[0]
    assert (best.code, best.run, best.channels, best.edges) == ("run-offset", 1, (X,), 2)
    assert (best.first_s, best.last_s) == pytest.approx((3.65, 7.15), abs=0.06)
    assert best.amount == pytest.approx(0.8, rel=0.05)
    excess = float(read_wrongly({(1, X): reads}) @ read_wrongly({(1, X): reads}))
    assert found.excess == pytest.approx(excess, rel=0.1)
    assert found.rest == pytest.approx(RUN.size, rel=0.1)
    assert told({(1, X): reads}, "run-offset") is None
    assert told({}) is None


def test_steps_of_a_zero_are_told_one_by_one():
    """Nothing, −1 since 2.1 s, −0.3 since 5.2 s, −1.3 since 9.3 s."""
    reads = -1.0 * (T > 2.08) + 0.7 * (T > 5.18) - 1.0 * (T > 9.28)
    best = told({(0, X): reads}).found[0]
    assert (best.code, best.run, best.channels, best.edges) == ("run-step", 0, (X,), 3)
    times, amounts = zip(*best.steps, strict=True)
    assert times == pytest.approx((2.1, 5.2, 9.3), abs=0.06)
    assert amounts == pytest.approx((-1.0, 0.7, -1.0), rel=0.1)
    assert (best.amount, best.first_s) == pytest.approx((sum(amounts), times[0]))


def test_a_time_constant_is_found_between_those_that_are_tried():
    lost = {(k, F): passed(T, values_of(k, F), 3.2) - values_of(k, F) for k in (0, 1)}
    best = told(lost).found[0]
    assert (best.code, best.channels) == ("ac-coupled", (F,))
    assert best.amount == pytest.approx(3.2, rel=0.05)


def test_a_tension_that_is_the_only_channel_and_fades_may_be_that_of_a_load(monkeypatch):
    lost = {(k, F): passed(T, values_of(k, F), 3.2) - values_of(k, F) for k in (0, 1)}
    monkeypatch.setattr("tsas_cli.diagnosis.faults.candidates._common", lambda reads: (F,))
    found = told(lost)
    assert found is None or found.found[0].code != "ac-coupled"


@pytest.mark.parametrize(
    ("zero", "first_s", "tolerated"),
    [(0.29, None, True), (-0.29, None, True), (0.31, None, False), (0.29, 3.0, False)],
)
def test_a_zero_within_three_deviations_of_every_rigs_is_no_fault(zero, first_s, tolerated):
    """Six thousandths of 50 N; a zero that steps in a run is a fault."""
    errors = SimpleNamespace(
        run=SimpleNamespace(measured={F: np.array([-50.0, 9.0])}), samples={F: np.array([0, 1])}
    )
    bench = SimpleNamespace(closed=[errors], channels=[F])
    fault = Candidate("run-offset", 1, (F,), zero, 9.0, 0 if first_s is None else 1, first_s)
    assert s._is_tolerated_zero(bench, fault) == tolerated
    assert not s._is_tolerated_zero(bench, replace(fault, code="run-gain"))
    assert not s._is_tolerated_zero(bench, replace(fault, channels=(X,)))


@pytest.mark.parametrize(("friction", "found"), [(0.055, False), (0.065, True), (-0.065, True)])
def test_a_friction_of_a_runs_own_is_beyond_three_deviations(friction, found):
    """One is a fiftieth; of two runs, each differs by half of it from their mean."""
    search = search_of(NOISE - friction * JACOBIAN[:, 0] * RUN)
    result = s.fault_of_recording(search, ())
    assert (result is not None) == found
    if found:
        best = result.found[0]
        assert (best.code, best.channels, best.alone) == ("run-friction", (), True)
        assert best.amount == pytest.approx(friction if best.run else -friction, rel=0.02)
    assert s.fault_of_recording(search, ("run-friction",)) is None


@pytest.mark.parametrize(
    ("more", "said"),
    [(0.2, "by -10 % (run a) to +10 % (run b),"), (-0.2, "by -10 % (run b) to +10 % (run a),")],
)
def test_frictions_that_differ_by_more_than_scatter_are_said(more, said):
    trial = trial_of(NOISE - more * JACOBIAN[:, 0] * RUN)
    frictions = frictions_of(trial, TOLERATED, RUN)
    assert frictions == pytest.approx([-0.5 * more, 0.5 * more], rel=0.02)
    runs = [Run(id=name, file="a", sha256=64 * "0") for name in "ab"]
    assert said in differing(frictions, runs).sentence
    assert differing(0.55 * frictions, runs) is None


@pytest.mark.parametrize(
    ("noise", "rest", "convinces"),
    [(100.0, 500.0, True), (100.0, 600.0, False), (160.0, 600.0, True)],
)
def test_a_fault_beside_which_all_runs_err_is_no_reason(noise, rest, convinces):
    """Of squares of 1,600: more than 0.3 of the excess, and four times the noise, are left."""
    fault = s.FoundFault((Candidate("run-gain", 1, (F,), 0.2, 9.0),), 1.2, 600.0, rest, 1000.0)
    assert s._convinces(fault, noise) == convinces


@pytest.mark.parametrize(("free", "mean_square"), [((), 9.0), (("friction_coefficient",), 1.0)])
def test_where_no_friction_is_fitted_or_only_noise_is_left_none_is_of_a_runs_own(free, mean_square):
    unknowns = tuple(Unknown(name, None, 0.0, -9.0, 9.0, 1.0) for name in free)
    bench, trial = SimpleNamespace(free=unknowns), SimpleNamespace(mean_square=mean_square)
    assert frictions_that_explain(bench, trial).size == 0
