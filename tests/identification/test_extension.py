"""Which numbers a hypothesis frees, and where it needs a mesh."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.identification import extension as e
from tsas_cli.identification.extension import _parameters
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.fit_problem import FitProblem, unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import FittedModel
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES


def test_an_effect_frees_its_own_parameters_and_nothing_else():
    for effect in EFFECTS:
        own = [f"{effect.name}.{p.name}" for p in effect.parameters]
        assert _parameters([effect.name], has_force=True) == own
    both = _parameters(["free_tendon", "backlash"], has_force=True)
    assert {name.split(".")[0] for name in both} == {"free_tendon", "backlash"}
    assert _parameters([], has_force=True) == []


def test_without_a_force_a_compliance_at_the_load_is_not_fitted():
    with_force, without = (_parameters(["load_law"], has_force=known) for known in (True, False))
    assert set(with_force) - set(without) == {"load_law.compliance_mm_per_N"}
    assert not any(name.endswith(("travel_mm", "low_mm", "high_mm")) for name in with_force)


ZERO = "x_in_zero_mm"
PROXIMAL = "free_tendon.proximal_length_mm"
SIZE = QUANTITIES[PROXIMAL].size


def zero_of(run, initial=0.0):
    return Unknown(ZERO, run, initial, -50.0, 50.0, 1.0)


class Run:
    """A run whose residuals say what rig it was asked for."""

    count = 5

    def __init__(self, name, drive="drive"):
        self.name, self.samples = name, {f"{name}_N": 1, "f_in_N": 2}
        self.simulation = SimpleNamespace(drive=drive)
        self.run = SimpleNamespace(has_force=True)

    def residuals(self, rig):
        self.asked = rig
        lengths = rig.effects.free_tendon
        return np.array([rig.x_in_zero_mm, *lengths, rig.bend_slope, rig.bend_bow])


def trial_of(unknowns=(), values=(), residual=None, *, J=None, at_bound=None, sizes=(), mesh=False):
    values = np.array(values, dtype=float)
    bound = np.zeros(values.size, bool) if at_bound is None else np.array(at_bound)
    solution = Solution(values, bound, residual, J, True, "", 1)
    return HypothesisFit(("free_tendon",), tuple(unknowns), solution, tuple(sizes), mesh)


def test_residuals_and_slopes_are_told_run_by_run():
    residual, J = np.arange(5.0), np.arange(10.0).reshape(5, 2)
    trial = trial_of(residual=residual, J=J, sizes=(2, 3))
    assert trial.mean_square == 6.0  # 0, 1, 4, 9, 16
    (a, Ja), (b, Jb) = trial.parts
    assert (a.tolist(), b.tolist()) == ([0.0, 1.0], [2.0, 3.0, 4.0])
    assert (Ja.tolist(), Jb.tolist()) == (J[:2].tolist(), J[2:].tolist())


def test_values_move_so_that_changes_are_taken_up():
    """What is at its bound stays: of 3 and 4 along two columns only the first is taken up."""
    J = np.array([[2.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    changes = np.array([[6.0, 0.0], [4.0, 1.0], [5.0, 0.0]])
    free = trial_of(values=(0.0, 0.0), J=J).moved_by(changes)
    np.testing.assert_allclose(free, [[-3.0, 0.0], [-4.0, -1.0]], atol=1e-12)
    bound = trial_of(values=(0.0, 0.0), J=J, at_bound=[False, True]).moved_by(changes)
    np.testing.assert_allclose(bound, [[-3.0, 0.0], [0.0, 0.0]], atol=1e-12)


def test_values_are_those_of_effects_in_their_units():
    trial = trial_of([zero_of(0), unknown_of(PROXIMAL)], [0.5, 2.0])
    assert trial.values() == {PROXIMAL: 2.0 * SIZE}
    assert trial.solver == "closed form"
    assert trial_of(mesh=True).solver == "slip chain, 40 nodes"


@pytest.fixture
def bench(monkeypatch):
    """Two runs; the zero of each is free, and was found at 1 and 2 mm; another is fixed."""

    def make(closed=(True, True)):
        drives = dict(zip(("drive a", "drive b"), closed, strict=True))
        monkeypatch.setattr(e, "is_closed", lambda rig, drive: drives[drive])
        monkeypatch.setattr(e, "meshed", lambda run, nodes, *_: Run(f"{run.name} {nodes}"))
        sought = (zero_of(0), Unknown("preload_N", 0, 9.0, 0.0, 99.0, 1.0), zero_of(1))
        errors = (Run("a", "drive a"), Run("b", "drive b"))
        problem = FitProblem(
            Model(()), Model(()), ("a", "b"), (GROUP_A, GROUP_A), sought, errors, ()
        )
        values = np.array([1.0, np.log(30.0), 2.0])
        return e.bench_of(FittedModel(problem, values, (0, 2), errors, Model(()), None, ()))

    return make


def test_the_longest_stroke_is_the_widest_motion_of_a_run_by_displacement(bench):
    def run(column, *values):
        conditioned = {column: SimpleNamespace(values=np.array(values))}
        return SimpleNamespace(run=SimpleNamespace(conditioned=conditioned))

    runs = run("x_in_mm", -5.0, 15.0, 3.0), run("x_in_mm", 40.0, 50.0), run("f_in_N", 0.0, 90.0)
    assert replace(bench(), closed=runs).longest_stroke_mm == 20.0
    assert replace(bench(), closed=runs[2:]).longest_stroke_mm == math.inf


def test_an_uneven_sheath_is_bent_by_a_twentieth_more_here_than_there(bench):
    """The residuals that say slope and bow of the bend change by that, each in its own way."""
    trial = trial_of([zero_of(0), zero_of(1)], [5.0, 6.0])
    found = bench().changes_on_chain(trial, [{"bend_slope": 0.05}, {"bend_bow": 0.05}])
    assert found.shape == (10, 2)
    expected = np.zeros((10, 2))
    expected[[3, 8], 0] = expected[[4, 9], 1] = 0.05
    np.testing.assert_allclose(found, expected, atol=1e-12)


PLAY = "backlash.play_mm"


@pytest.mark.parametrize(
    ("name", "at", "errors", "start"),
    [
        (PLAY, 0.0, {0.1: 2.0, 0.3: 0.5}, 0.3),  # behind a hill
        (PLAY, 0.0, {0.1: 0.4, 0.3: 0.5}, 0.1),
        (PLAY, 0.0, {0.1: 1.0, 0.3: 1.0}, None),
        (PLAY, 200.0, {0.1: 0.0, 0.3: 0.0}, None),  # at its other bound
        ("friction_coefficient", 0.0, {0.1: 0.0, 0.3: 0.0}, None),
    ],
)
def test_a_size_at_zero_is_tried_where_the_squares_may_be_smaller(name, at, errors, start):
    unknowns = [zero_of(0), unknown_of(name, at)]
    solution = trial_of(values=[1.5, at], residual=np.ones(1), at_bound=[False, True]).solution
    found = e.off_bounds(unknowns, solution, lambda v: np.array([errors[round(v[1], 6)]]))
    assert (found and [u.initial for u in found]) == (start and [1.5, start])
