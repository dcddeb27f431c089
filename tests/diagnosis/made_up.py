"""Searches over fits and squares that are made up by the set of effects."""

from types import SimpleNamespace

import numpy as np

from tsas_cli.diagnosis import search
from tsas_cli.diagnosis.search import Search
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.screening import Screened

BLOCKS, SIZE = 20, 200
OF = {e.name: e for e in EFFECTS}


def names(*found):
    return frozenset(found)


class Bench:
    """Fits whose mean square is given by the set of effects; `mesh` are those that need it.

    A list of mean squares is that of one fit after the other.
    """

    def __init__(self, mean_squares, mesh=(), weighed=0):
        self.mean_squares, self.mesh, self.weighed = mean_squares, mesh, weighed
        self.fits, self.closed = [], ()

    def on_mesh(self, effects):
        return bool(set(effects) & set(self.mesh))

    def fit(self, effects, start=None, *, near=None, on_mesh=False, values_only=False):
        fitted = frozenset(effects)
        self.fits.append(SimpleNamespace(fitted=fitted, start=start, near=near, on_mesh=on_mesh))
        value = self.mean_squares[fitted]
        value = value.pop(0) if isinstance(value, list) else value
        solution = SimpleNamespace(converged=True, residual=np.ones(SIZE), at_bound=[])
        return SimpleNamespace(
            mean_square=value,
            solution=solution,
            unknowns=[],
            on_mesh=on_mesh,
            weighed=self.weighed,
        )

    @property
    def fitted(self):
        return [fit.fitted for fit in self.fits]


def evenly(trial, folds):
    """Return a trial's held-out squares, spread evenly over the blocks."""
    return np.full(BLOCKS, trial.mean_square * SIZE / BLOCKS)


def without_tolerances(monkeypatch):
    """Let rigs be without tolerances."""
    monkeypatch.setattr(search, "tolerances", lambda bench, trial: None)
    monkeypatch.setattr(search, "with_tolerances", lambda trial, tolerated: trial)
    monkeypatch.setattr(search, "with_friction_of_runs", lambda trial, run: trial)
    monkeypatch.setattr(search, "is_in_line", lambda trial, run, session_s: False)


def search_over(bench, known, *step):
    folds = SimpleNamespace(block=np.arange(SIZE) * BLOCKS // SIZE, blocks=BLOCKS, run=None)
    effects = tuple(OF[name] for name in sorted(known))
    return Search(bench, folds, *step, effects=effects, tolerated={False: None, True: None})


def screened(name, part=0.5, signatures=None):
    signatures = np.zeros((SIZE, 1)) if signatures is None else signatures
    return Screened(OF[name], part, {f"{name}.{OF[name].parameters[0].name}": 1.0}, signatures)
