"""A search whose fits and squares are made up."""

from types import SimpleNamespace

import numpy as np

from tsas_cli.diagnosis import fits as fits_module
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.screening import Screened

BLOCKS, SIZE = 20, 200
OF = {e.name: e for e in EFFECTS}


def names(*found):
    return frozenset(found)


class Trial(SimpleNamespace):
    """A fit whose start beside others is the change that they make."""

    def ready_for(self, change):
        return SimpleNamespace(**vars(self), ready=change)


class Bench:
    """Fits whose mean square is given by the effects, or by a list of one after the other."""

    def __init__(self, mean_squares, mesh=()):
        self.mean_squares, self.mesh = mean_squares, mesh
        self.fits, self.closed, self.rigs = [], (), ()

    def on_mesh(self, effects):
        return bool(set(effects) & set(self.mesh))

    def fit(self, effects, start=None, *, near=None, on_mesh=False, values_only=False):
        fitted = frozenset(effects)
        self.fits.append(SimpleNamespace(fitted=fitted, start=start, near=near, on_mesh=on_mesh))
        value = self.mean_squares[fitted]
        value = value.pop(0) if isinstance(value, list) else value
        solution = SimpleNamespace(converged=True, residual=np.ones(SIZE), at_bound=[])
        return Trial(mean_square=value, solution=solution, unknowns=[], on_mesh=on_mesh)

    @property
    def fitted(self):
        return [fit.fitted for fit in self.fits]


def evenly(trial, folds):
    """Return a trial's held-out squares, spread evenly over the blocks."""
    return np.full(BLOCKS, trial.mean_square * SIZE / BLOCKS)


def without_tolerances(monkeypatch):
    """Let rigs be without tolerances."""
    monkeypatch.setattr(fits_module, "tolerances", lambda bench, trial: None)
    monkeypatch.setattr(fits_module, "with_tolerances", lambda trial, tolerated: trial)
    tolerances_take(monkeypatch, 0.0)
    monkeypatch.setattr(fits_module, "without_travel", lambda tolerated: tolerated)
    monkeypatch.setattr(fits_module, "with_scale_and_zeros", lambda bench, trial, none: none)
    monkeypatch.setattr(fits_module, "with_friction_of_runs", lambda trial, run: trial)
    monkeypatch.setattr(fits_module, "is_in_line", lambda trial, run, session_s: False)


def tolerances_take(monkeypatch, share):
    """Let tolerances take a share of the squares that any effects leave."""
    monkeypatch.setattr(
        fits_module,
        "without_tolerances",
        lambda trial, tolerated, run: np.sqrt(1.0 - share) * trial.solution.residual,
    )


def fits_over(bench, known):
    folds = SimpleNamespace(block=np.arange(SIZE) * BLOCKS // SIZE, blocks=BLOCKS, run=None)
    effects = tuple(OF[name] for name in sorted(known))
    return Fits(bench, folds, effects=effects, tolerated={False: None, True: None})


def screened(name, part=0.5, signatures=None, start=1.0):
    signatures = np.zeros((SIZE, 1)) if signatures is None else signatures
    initial = {f"{name}.{OF[name].parameters[0].name}": start}
    return Screened(OF[name], part, initial, signatures, np.ones(SIZE))


A, B, C, D, E = "backlash", "drive_friction", "free_tendon", "load_friction", "load_inertia"
CONVINCES, DOES_NOT = Reduction(0.5, 4.0), Reduction(0.5, 1.0)
ALL_CONVINCE = [(name, CONVINCES) for name in (A, C, D)]


def search_over(monkeypatch):
    """Return what makes a search over mean squares; held-out squares are spread evenly."""
    monkeypatch.setattr(fits_module, "held_out_squares", evenly)
    without_tolerances(monkeypatch)
    return lambda mean_squares: fits_over(Bench(mean_squares), (A, C, D))


def seen(fits, at, *parts, signatures=None):
    fits.screened[at] = [
        screened(name, part, None if signatures is None else signatures[name])
        for name, part in parts
    ]


def pairs(count):
    """Return orthogonal directions, so that each pair's part is what it is given."""
    return np.linalg.qr(np.random.default_rng(1).standard_normal((SIZE, count)))[0].T
