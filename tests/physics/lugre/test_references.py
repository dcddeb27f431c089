"""The stored reference solutions of the dynamic model: made by the code, agreed on."""

import json
from typing import NamedTuple

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals import compiled, ode
from benchmarks.lugre_rivals.drives import Samples, Sine, Sines, noisy
from benchmarks.lugre_rivals.ode import Model, Output, Problem
from benchmarks.lugre_rivals.references import FOLDER, KEY, differences, problems, record
from benchmarks.lugre_rivals.solution import NotAvailableError, Tolerance
from benchmarks.lugre_rivals.solvers import RIVALS, lsoda

PROBLEMS = problems()
AGREED = 1e-5  # of the range


class Stored(NamedTuple):
    time_s: np.ndarray
    x_in_mm: np.ndarray
    output: Output
    about: dict


def stored(name):
    table = pq.read_table(FOLDER / f"{name}.parquet")
    columns = {key: table[key].to_numpy() for key in table.column_names}
    output = Output(*(columns[key] for key in Output._fields))
    about = json.loads(table.schema.metadata[KEY])
    return Stored(columns["time_s"], columns["x_in_mm"], output, about)


def test_every_problem_has_its_file_and_no_other_is_there():
    assert sorted(path.stem for path in FOLDER.glob("*")) == sorted(PROBLEMS)


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_files_are_of_the_problems_that_the_code_describes(name):
    file, problem = stored(name), PROBLEMS[name]
    assert {key: file.about[key] for key in ("model", "drive")} == record(problem)
    np.testing.assert_array_equal(file.time_s, problem.time_s)
    np.testing.assert_allclose(
        file.x_in_mm, problem.drive.position(problem.time_s), rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("name", PROBLEMS)
def test_two_solvers_agreed(name):
    assert max(stored(name).about["largest_difference_over_range"].values()) < AGREED


def test_a_third_solver_finds_the_same():
    tolerance = Tolerance(y_mm=1e-9, w_mm_s=1e-5, z_mm=1e-10)
    found = lsoda(PROBLEMS["a-10"], tolerance, max_order=5)
    assert max(differences(found, stored("a-10").output).values()) < AGREED


# The others are slow where the drive is sampled.
@pytest.mark.parametrize(
    ("rival", "name"),
    [*((rival, "nested-50") for rival in RIVALS), *((rival, "noisy-50") for rival in RIVALS[:2])],
    ids=lambda one: getattr(one, "name", one),
)
def test_rivals_solve_the_same_equations(rival, name):
    """At their loose tolerances they miss by about 0.05 %."""
    try:
        found = rival.solve(PROBLEMS[name], rival.tolerance)
    except NotAvailableError as reason:
        pytest.skip(str(reason))
    assert max(differences(found, stored(name).output).values()) < 3e-3


def test_the_samples_of_the_noisy_run_are_in_its_file():
    file, drive = stored("noisy-50"), PROBLEMS["noisy-50"].drive
    again = Samples(tuple(file.x_in_mm.tolist()))
    assert file.x_in_mm[0] == 0.0
    for time_s in (0.0, 0.1234, 0.5999):
        np.testing.assert_allclose(again.motion(time_s), drive.motion(time_s), rtol=1e-9)
    assert 0.1 < file.time_s[np.argmax(file.x_in_mm)] < 0.5  # turns within


@pytest.mark.parametrize("lumps", [1, 2, 7])
@pytest.mark.parametrize("kind", ["sines", "samples"])
def test_compiled_equations_and_jacobian_are_those_in_numpy(lumps, kind):
    sines = Sines((Sine(10.0, 1.0), Sine(3.0, 5.0)))
    drive = sines if kind == "sines" else noisy(sines, seconds=0.1)
    problem = Problem(Model(lumps=lumps), drive, np.zeros(1))
    given = np.array(problem.model.constants()), *drive.tables()
    t, rng = 0.0423, np.random.default_rng(lumps)
    state = 1e-3 * rng.standard_normal(3 * lumps + 1)
    state[1:-1:3] = 0.01 * rng.standard_normal(lumps) - drive.motion(t)[1]  # Stribeck's speeds
    expected, out = ode.rate(t, state, problem), np.empty_like(state)
    compiled.rate(t, state, out, *given)
    np.testing.assert_allclose(out, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)))

    columns, J = np.zeros((state.size, compiled.BANDS)), np.zeros((state.size, state.size))
    compiled.jacobian(t, state, columns, *given)
    compiled.spread(columns, J)
    steps = 1e-7 * np.eye(state.size)
    slopes = np.transpose(
        [(ode.rate(t, state + h, problem) - ode.rate(t, state - h, problem)) / 2e-7 for h in steps]
    )
    scale = np.max(np.abs(slopes), axis=1, keepdims=True)
    np.testing.assert_allclose(J / scale, slopes / scale, rtol=0, atol=1e-6)
