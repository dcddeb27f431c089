"""Make the tight reference solutions in tests/physics/lugre/references again.

python -m benchmarks.lugre_rivals.references [NAME …] [--out DIR]

Each is solved by CVODE (BDF, equations compiled) and by scipy's Radau (an implicit Runge-Kutta
method, equations in numpy). What CVODE found is stored, and by how much Radau differs.
"""

import argparse
import json
import math
import sys
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.lugre_rivals.drives import Sine, Sines, noisy
from benchmarks.lugre_rivals.ode import Output, Problem, group
from benchmarks.lugre_rivals.solution import Tolerance
from benchmarks.lugre_rivals.solvers import radau_in_numpy, sundae
from tsas_cli.support.files import own_file

FOLDER = Path(__file__).parents[2] / "tests" / "physics" / "lugre" / "references"
KEY = b"lugre"
INTERVALS = 400
CVODE_TOLERANCE = Tolerance(y_mm=1e-10, w_mm_s=1e-7, z_mm=1e-11, relative=1e-10)
RADAU_TOLERANCE = Tolerance(y_mm=1e-8, w_mm_s=1e-5, z_mm=1e-9, relative=1e-8)
SPEEDS_S = 13.0  # one slow stroke there and back, at 200 Hz
RAMP_S, NOISY_S = 0.4, 0.6  # the noisy run turns after the first


def problems() -> dict[str, Problem]:
    """Return what is solved, by the name of its file."""
    found = {}
    for name in ("a", "b"):
        for lumps in (10, 50, 120):
            model, drive = group(name, lumps=lumps)
            periods = 1.5 * 2.0 * math.pi / drive.sines[0].omega_rad_s
            time_s = np.linspace(0.0, periods, INTERVALS + 1)
            found[f"{name}-{lumps}"] = Problem(model, drive, time_s)
    model, drive = group("a")
    nested = Sines((*drive.sines, Sine(3.0, 5.0)))
    found["nested-50"] = Problem(model, nested, np.linspace(0.0, 2.0 * math.pi, INTERVALS + 1))
    model = replace(
        model,
        bristle_damping=2.0,
        viscous_N_s_per_mm=0.4,
        stribeck_excess=0.1,
        stribeck_speed_mm_s=8.0,
    )
    fast_and_slow = Sines((Sine(10.0, 0.5), Sine(3.0, 4.0)))
    found["speeds-50"] = Problem(model, fast_and_slow, np.linspace(0.0, SPEEDS_S, 2601))
    model, drive = group("b")
    omega = drive.sines[0].omega_rad_s
    turning = noisy(Sines((Sine(10.0, omega, math.pi / 2.0 - omega * RAMP_S),)), seconds=NOISY_S)
    found["noisy-50"] = Problem(model, turning, np.arange(len(turning.x_in_mm)) / turning.rate_Hz)
    return found


def tight(problem: Problem) -> Output:
    """Solve by CVODE with all its orders and a tolerance far below what a rival is asked for."""
    return sundae(problem, CVODE_TOLERANCE, max_order=5, max_newton=3, steps_only=False)


def differences(found: Output, exact: Output) -> dict[str, float]:
    """Return the largest difference of each channel, over the channel's range."""
    return {
        channel: float(np.max(np.abs(a - b)) / np.ptp(b))
        for channel, a, b in zip(Output._fields, found, exact, strict=True)
    }


def record(problem: Problem) -> dict[str, Any]:
    """Return the parameters of a problem; the samples of a noisy one are the file's own column."""
    return {"model": problem.model.record(), "drive": problem.drive.record()}


def make(name: str, problem: Problem, out: Path) -> dict[str, float]:
    """Solve one twice, write its file, and return how far the solvers differ."""
    exact = tight(problem)
    off = differences(radau_in_numpy(problem, RADAU_TOLERANCE), exact)
    about = record(problem) | {
        "solver": f"CVODE of scikit-sundae {metadata.version('scikit-sundae')}",
        "tolerance": CVODE_TOLERANCE._asdict(),
        "other_solver": f"Radau of scipy {metadata.version('scipy')}",
        "other_tolerance": RADAU_TOLERANCE._asdict(),
        "largest_difference_over_range": off,
    }
    x_in = problem.drive.position(problem.time_s)
    columns = {"time_s": problem.time_s, "x_in_mm": x_in, **exact._asdict()}
    table = pa.table(columns).replace_schema_metadata({KEY: json.dumps(about)})
    with own_file(out / f"{name}.parquet") as path:
        pq.write_table(table, path, compression="zstd")
    return off


def main() -> None:
    """Make all of them, or those that are named."""
    known = problems()
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", help=f"of {', '.join(known)}; all where none is named")
    parser.add_argument("--out", type=Path, default=FOLDER, metavar="DIR")
    call = parser.parse_args()
    unknown = set(call.names) - set(known)
    if unknown:
        parser.error(f"no reference {', '.join(sorted(unknown))}")
    for name in call.names or known:
        off = make(name, known[name], call.out)
        shares = ", ".join(f"{channel} {share:.1e}" for channel, share in off.items())
        print(f"{name}: the solvers differ by {shares} of the range", file=sys.stderr)


if __name__ == "__main__":
    main()
