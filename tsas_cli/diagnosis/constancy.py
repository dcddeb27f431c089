"""Whether a named effect's parameters have one value wherever the recordings determine them.

A mechanism has one value; what stands in for another mechanism has another one wherever it is
asked (invariant prediction, Peters, Buehlmann and Meinshausen 2016). An effect's columns of the
Jacobian are split by direction, by thirds of each signal, and by run. Where values of their own for
the parts predict held-out data better than one value does, the effect is not constant; but from run
to run, mounted anew, it may differ by a fifth. Each run has a friction of its own meanwhile, unless
that is all the effect does, and load cells and bend are within their tolerances. Linear: no
simulation.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from tsas_cli.diagnosis.evidence import Reduction, gain
from tsas_cli.diagnosis.friction_scatter import is_scatter, with_friction_of_runs
from tsas_cli.diagnosis.held_out import (
    Folds,
    gauss_newton_step,
    held_out_squares,
    in_stretches,
    normal_equations,
)
from tsas_cli.diagnosis.signals import DIRECTION, RUN
from tsas_cli.diagnosis.tolerances import GROWTH, without_tolerances
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.support.arrays import Floats, Indices

LEAST_GAIN = 0.03  # least reduction of the squares by values of their own; right names reach 0.01
MOST_APART = 2.0  # factor between the sizes in the parts of a split; of right names at most 1.8
OF_MOUNTING = 1.2  # the same, of runs, which are mounted anew: of a right name 1.15
THIRDS = ("low", "middle", "high")
DIRECTIONS = ("releasing", "pulling")


@dataclass(frozen=True)
class Split:
    """A parameter with values of its own for the parts of the data.

    `by` is the signal that the data are split by, `gain` the reduction of the held-out squares by
    the split, `values` the parameter's value in each part, by the part's name.
    """

    parameter: str
    by: str
    gain: Reduction
    values: tuple[tuple[str, float], ...]

    def of_one_size(self, most: float = MOST_APART) -> bool:
        """Return whether the sizes in the parts are within a factor of each other."""
        quantity = QUANTITIES[self.parameter]
        neutral = 0.0 if quantity.shape else quantity.default
        sizes = sorted(value - neutral for _, value in self.values)
        nearest, farthest = sorted((sizes[0], sizes[-1]), key=abs)
        return nearest * farthest > 0.0 and abs(farthest) <= most * abs(nearest)


def worst_split(
    trial: HypothesisFit,
    effect: str,
    folds: Folds,
    signals: dict[str, Floats],
    runs: tuple[str, ...],
    tolerated: Floats,
) -> Split | None:
    """Return the split with the largest gain where an effect is not constant, else None.

    A split by run holds out stretches of the runs, whose ids are `runs`. `signals` are those at
    each residual, shape (n,) each; `tolerated` is what one standard deviation of each tolerance
    changes there, shape (n, m).
    """
    trial, columns = _with_frictions(beside_tolerances(trial, tolerated), effect, folds)
    if not columns:
        return None
    stretches = in_stretches(folds)
    before = cache(lambda by_run: held_out_squares(trial, stretches if by_run else folds))
    worst: Split | None = None
    for by, (labels, part) in _parts(signals, folds.run, runs).items():
        extended, shape = _split(trial, columns, part, len(labels))
        after = held_out_squares(extended, stretches if by == RUN else folds)
        found = gain(before(by == RUN), after)
        if found.beyond(LEAST_GAIN) and (worst is None or found.part > worst.gain.part):
            name, values = _values(trial, extended, columns, shape)
            split = Split(name, by, found, tuple(zip(labels, values, strict=True)))
            if by != RUN or not split.of_one_size(OF_MOUNTING):
                worst = split
    return worst


def absorbed_by(
    fewer: HypothesisFit,
    whole: HypothesisFit,
    effect: str,
    folds: Folds,
    signals: dict[str, Floats],
) -> str | None:
    """Return the signal over which another law of an effect does what one more effect does.

    `whole` is the fit with one effect more than `fewer`, both `beside_tolerances`: what it gains
    has to be a gain too where the `effect` of both has values of its own for the parts of a
    signal. None where it is, and where tolerances and frictions alone do what it does.
    """
    trials = [_with_frictions(trial, effect, folds) for trial in (fewer, whole)]
    if not all(columns for _, columns in trials):
        return None
    if not gain(*(held_out_squares(trial, folds) for trial, _ in trials)).convincing:
        return None
    for by, (labels, part) in _parts(signals, folds.run, ()).items():
        split = (_split(trial, columns, part, len(labels))[0] for trial, columns in trials)
        if not gain(*(held_out_squares(trial, folds) for trial in split)).convincing:
            return by
    return None


def beside_tolerances(trial: HypothesisFit, tolerated: Floats) -> HypothesisFit:
    """Return a fit with the residual that plausible tolerances do not explain."""
    residual = without_tolerances(trial, tolerated)
    return replace(trial, solution=replace(trial.solution, residual=residual))


def _with_frictions(
    trial: HypothesisFit, effect: str, folds: Folds
) -> tuple[HypothesisFit, list[int]]:
    """Return a fit with the friction of each run, and the columns of an effect that are split.

    How a size grows with the tension is none: a part of the data at one tension does not show it.
    """
    J = trial.solution.jacobian
    columns = [
        j
        for j, u in enumerate(trial.unknowns)
        if u.name.split(".")[0] == effect and u.name != GROWTH and not trial.solution.at_bound[j]
    ]
    within_runs = [j for j in columns if not is_scatter(trial, J[:, j], folds.run)]
    if within_runs:  # what differs from run to run alone is the friction of each
        return with_friction_of_runs(trial, folds.run), within_runs
    return trial, columns


def _parts(
    signals: dict[str, Floats], run: Indices, runs: tuple[str, ...]
) -> dict[str, tuple[tuple[str, ...], Indices]]:
    """Return the labels of the parts of each signal, and the part of each residual."""
    parts: dict[str, tuple[tuple[str, ...], Indices]] = {}
    for name, values in signals.items():
        if name == DIRECTION:
            parts[name] = DIRECTIONS, (values > 0.0).astype(np.int64)
            continue
        size = np.abs(values) if name.startswith("speed") else values
        edges = np.quantile(size, (1.0 / 3.0, 2.0 / 3.0))
        parts[name] = THIRDS, np.searchsorted(edges, size).astype(np.int64)
    if len(runs) > 1:
        parts[RUN] = tuple(f"run {name}" for name in runs), run
    return {
        name: (labels, part)
        for name, (labels, part) in parts.items()
        if np.unique(part).size == len(labels)
    }


def _split(
    trial: HypothesisFit, columns: list[int], part: Indices, count: int
) -> tuple[HypothesisFit, tuple[int, int]]:
    """Return the fit with a further column for each but the first part of each given column.

    A further value is expected within the size of the effect itself.
    """
    solution = trial.solution
    further, names = [], []
    for j in columns:
        u = trial.unknowns[j]
        size = _size(u.name, float(solution.values[j]))
        for k in range(1, count):
            further.append(solution.jacobian[:, j] * (part == k))
            names.append((f"{u.name} {k}", None, size))
    return trial.with_columns(names, np.column_stack(further)), (len(columns), count - 1)


def _size(name: str, value: float) -> float:
    """Return the plausible size of a further value: the value's own; 1 for a logarithm."""
    return 1.0 if QUANTITIES[name].positive else max(abs(_from_neutral(name, value)), 1e-3)


def _from_neutral(name: str, value: float) -> float:
    """Return by how much a scaled value differs from the neutral one."""
    quantity = QUANTITIES[name]
    return value - quantity.scaled(quantity.default)


def _values(
    trial: HypothesisFit, split: HypothesisFit, columns: list[int], shape: tuple[int, int]
) -> tuple[str, list[float]]:
    """Return the parameter that differs most between the parts, and its value in each."""
    solution = split.solution
    step = gauss_newton_step(split, normal_equations(split))
    further = step[-shape[0] * shape[1] :].reshape(shape)
    sizes = [split.unknowns[len(trial.unknowns) + k * shape[1]].scale for k in range(shape[0])]
    k = int(np.argmax(np.abs(further).max(axis=1) / sizes))
    j = columns[k]
    quantity = QUANTITIES[trial.unknowns[j].name]
    scaled = solution.values[j] + step[j] + np.concatenate(([0.0], further[k]))
    inside = np.clip(scaled, trial.unknowns[j].lower, trial.unknowns[j].upper)
    return quantity.name, [quantity.unscaled(float(v)) for v in inside]
