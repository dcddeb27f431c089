"""A fit changes nothing that it is given: problems and benches serve again, whatever was done."""

from dataclasses import replace

import numpy as np
import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.diagnosis.diagnose import bench_folds
from tsas_cli.diagnosis.held_out import held_out_squares
from tsas_cli.identification.extension import bench_of, reweighted_bench
from tsas_cli.identification.fit_problem import prepare_fit
from tsas_cli.identification.joint_fit import misfit, solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.run_errors import meshed, reweighted
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.tendon import Rig


@pytest.fixture(scope="module")
def problem():
    runs = [prepared(Rig(), sine(), seed=k, run_id=name) for k, name in enumerate("ab")]
    sheet = data_sheet(manifest(*runs))
    return prepare_fit(sheet, sheet, runs)


@pytest.fixture(scope="module")
def solved(problem):
    return solve_fit(problem)


def residuals_of(errors, rigs):
    return np.concatenate([run.residuals(rig) for run, rig in zip(errors, rigs, strict=True)])


def weights_of(errors):
    return [run.weights[name] for run in errors for name in run.samples]


def same(first, second):
    return all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def test_a_problem_that_is_solved_twice_gives_the_same_twice(problem):
    before = residuals_of(problem.errors, problem.rigs)
    weights = [w.copy() for w in weights_of(problem.errors)]
    first, second = solve_fit(problem), solve_fit(problem)
    assert np.array_equal(first.values, second.values)
    assert first.model == second.model
    assert np.array_equal(first.fitted.stderr, second.fitted.stderr)
    assert same(weights_of(first.errors), weights_of(second.errors))
    assert misfit(first) == misfit(second)
    assert np.array_equal(residuals_of(problem.errors, problem.rigs), before)
    assert same(weights_of(problem.errors), weights)


def test_a_solution_is_weighed_where_it_ended(problem, solved):
    """The problem stays weighed at its initial values."""
    assert not same(weights_of(problem.errors), weights_of(solved.errors))
    there = [reweighted(e, rig) for e, rig in zip(problem.errors, solved.rigs, strict=True)]
    assert same(weights_of(there), weights_of(solved.errors))


def test_weighing_again_leaves_the_old_bench_as_it_was(solved):
    """The closed form and the meshes of either bench have the weights of that bench."""
    bench = bench_of(solved)
    folds = bench_folds(bench)
    nominal = bench.fit()
    away = replace(nominal.solution, values=1.01 * nominal.solution.values)
    trial = replace(nominal, solution=away)
    meshes = (bench.closed, bench.meshed, bench.coarse)
    before = [residuals_of(runs, bench.rigs) for runs in meshes]
    squares = held_out_squares(nominal, folds)
    other = reweighted_bench(bench, trial)
    changed = [residuals_of(runs, bench.rigs) for runs in (other.closed, other.meshed)]
    assert same([residuals_of(runs, bench.rigs) for runs in meshes], before)
    assert not np.array_equal(changed[0], before[0])
    assert not np.array_equal(changed[1], before[1])
    assert same(weights_of(other.meshed), weights_of(other.closed))
    assert same(weights_of(other.coarse), weights_of(other.closed))
    assert np.array_equal(bench.fit().solution.values, nominal.solution.values)
    assert np.array_equal(held_out_squares(bench.fit(), folds), squares)


def test_a_mesh_takes_the_weights_along(solved):
    run, rig = solved.errors[0], solved.rigs[0]
    before = run.residuals(rig)
    on_mesh = meshed(run, 12)
    assert on_mesh.weights is run.weights
    assert not np.array_equal(on_mesh.residuals(rig), before)
    assert np.array_equal(run.residuals(rig), before)


def test_only_what_belongs_to_a_run_alone_is_free_where_shared_values_are_fixed(problem):
    own = prepare_fit(problem.initial, problem.fixed, problem.runs, shared=False)
    assert [u for u in problem.unknowns if u.run is not None] == list(own.unknowns)
    found = solve_fit(own)
    assert found.free
    assert all(u.run is not None for u in found.free)
    stiffness = "tendon_stiffness_N"
    assert found.model.value(stiffness) == problem.fixed.value(stiffness)
    frictions = [[rig.friction_coefficient for rig in fit.rigs] for fit in (problem, found)]
    assert frictions[0] == frictions[1]
