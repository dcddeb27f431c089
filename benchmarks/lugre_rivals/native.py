"""CVODE wholly in C: `cvode.c` is built where a compiler and the headers of SUNDIALS are there."""

import ctypes
import subprocess
import tempfile
from ctypes import POINTER, c_double, c_int, c_long
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.lugre_rivals.drives import Floats
from benchmarks.lugre_rivals.ode import Output, Problem, output
from benchmarks.lugre_rivals.solution import NotAvailableError, Tolerance

# As -ffast-math, but for its start-up code, which would change the arithmetic of the whole process.
FLAGS = "-O3 -march=native -fno-math-errno -fno-trapping-math -fno-signed-zeros -fassociative-math"
LIBRARIES = (
    "-lsundials_cvode -lsundials_nvecserial -lsundials_sunmatrixband -lsundials_sunlinsolband"
)


class Settings(NamedTuple):
    """Options of CVODE beside the tolerance; `cvode.c` has the same order."""

    # What Newton may leave, of the error that a step may have; 0.1 is inaccurate.
    newton_coefficient: float = 0.0084
    # Relative change of step and order by which the matrix is factorised again.
    gamma_change: float = 0.05
    max_order: float = 2  # of the formulas
    max_newton: float = 3  # iterations of a step
    # After how many steps the matrix is factorised, and the Jacobian computed, in any case.
    steps_per_setup: float = 28
    steps_per_jacobian: float = 3
    least_growth: float = 1.56  # of the step, below which it is kept
    after_newton_failure: float = 0.1  # what is left of the step where Newton fails


def cvode_in_c(problem: Problem, tolerance: Tolerance) -> Output:
    """CVODE in C: right hand side, Jacobian, banded matrix, norm and output."""
    constants, (sines, pieces) = np.array(problem.model.constants()), problem.drive.tables()
    time_s = np.ascontiguousarray(problem.time_s)
    given = _Problem(
        problem.model.lumps,
        _pointer(constants),
        len(sines),
        _pointer(sines),
        len(pieces),
        _pointer(pieces),
    )
    options = np.array([tolerance.relative, *tolerance[:3], *Settings()])
    state, seen = problem.start(), np.empty((3, time_s.size))
    failed = _built().solve(
        ctypes.byref(given),
        _pointer(options),
        _pointer(state),
        c_long(time_s.size),
        _pointer(time_s),
        _pointer(seen),
    )
    if failed:
        raise RuntimeError(f"CVODE returned {failed}")
    return output(problem, *seen)


class _Problem(ctypes.Structure):
    _fields_ = (
        ("lumps", c_long),
        ("constants", POINTER(c_double)),
        ("sines", c_long),
        ("sine", POINTER(c_double)),
        ("pieces", c_long),
        ("piece", POINTER(c_double)),
    )


def _pointer(values: Floats) -> Any:
    """Return where the values are; the caller holds them as long as the pointer is used."""
    return values.ctypes.data_as(POINTER(c_double))


@cache
def _built() -> ctypes.CDLL:
    source = Path(__file__).with_name("cvode.c")
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "cvode.so"
        call = ["cc", *FLAGS.split(), "-shared", "-fPIC", str(source), "-o", str(library)]
        try:
            subprocess.run([*call, *LIBRARIES.split(), "-lm"], check=True, capture_output=True)
        except OSError as error:
            raise NotAvailableError("there is no C compiler `cc`") from error
        except subprocess.CalledProcessError as error:
            first = error.stderr.decode(errors="replace").strip().splitlines()[0]
            raise NotAvailableError(
                f"cvode.c needs SUNDIALS 6 with its headers (Debian: libsundials-dev): {first}"
            ) from error
        built = ctypes.CDLL(str(library))
    built.solve.restype = c_int
    return built
