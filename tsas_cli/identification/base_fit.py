"""The fit of the nominal parameters, with initial values from the phases and the data sheet."""

from collections.abc import Mapping, Sequence

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import FitProblem, prepare_fit
from tsas_cli.identification.initial_values import initial_values_of
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.phases import Segment, segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.stiffness import Slope, slopes
from tsas_cli.physics.parameters import NOMINAL_BY_NAME


def base_fit(
    stated: Model,
    runs: Sequence[Prepared],
    segments: Sequence[list[Segment]],
    measured: Sequence[list[Slope]],
    plausible: Mapping[str, tuple[float, float]] | None = None,
) -> FitProblem:
    """Return the joint fit of all runs as a problem to solve.

    `stated` has the values of parameters that are fixed, those of the data sheet for example;
    `plausible` are narrower bounds of some.
    """
    initial = _read_off(stated, runs, segments, measured)
    return prepare_fit(initial.over(stated), stated.over(initial), runs, plausible=plausible)


def with_own_values(model: Model, run: Prepared) -> Model:
    """Return a model with the parameters of one run fitted to it; all others are fixed."""
    parts = segment(run)
    initial = _read_off(model, [run], [parts], [slopes_of(run, parts)])
    own = Model(tuple(e for e in initial.estimates if e.run is not None))
    return solve_fit(prepare_fit(own.over(model), model.over(own), [run], shared=False)).model


def slopes_of(run: Prepared, segments: list[Segment]) -> list[Slope]:
    """Return the stiffness km of a run's phases, none where f_in or x_in was not measured."""
    f_in = run.measured.get("f_in_N")
    if f_in is None or "x_in_mm" not in run.conditioned:
        return []
    return slopes(run.conditioned["x_in_mm"].values, f_in, segments)


def _read_off(
    stated: Model,
    runs: Sequence[Prepared],
    segments: Sequence[list[Segment]],
    measured: Sequence[list[Slope]],
) -> Model:
    """Return initial values from the phases of the runs; the median where runs share one."""
    found: dict[tuple[str, str | None], list[float]] = {}
    for run, parts, km in zip(runs, segments, measured, strict=True):
        values = initial_values_of(run, parts, km, stated.rig(run.run))
        for name, value in values.items():
            owner = None if NOMINAL_BY_NAME[name].shared else run.run.id
            found.setdefault((name, owner), []).append(value)
    return Model(
        tuple(
            Estimate(name, float(np.median(values)), NOMINAL_BY_NAME[name].unit, "default", owner)
            for (name, owner), values in found.items()
        )
    )
