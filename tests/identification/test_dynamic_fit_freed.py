"""Which constants the dynamic fit frees, fixes or seeks again, on fits that are linear."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.physics.response import LUMPS
from tsas_cli.support.steps import SILENT

SLOPES = np.linalg.qr(np.random.default_rng(1).standard_normal((50, 2)))[0]

OWN = np.random.default_rng(2).standard_normal(50)

OWN = 10.0 * (OWN - SLOPES @ (SLOPES.T @ OWN)) / np.linalg.norm(OWN - SLOPES @ (SLOPES.T @ OWN))

NOTHING = Model(())


@dataclass(frozen=True)
class Fit:
    """A fit whose residual is linear in the logarithm of one value."""

    left: np.ndarray
    per_e: np.ndarray = field(default_factory=OWN.copy)
    names: tuple[str, ...] = ()  # of the free parameters
    further: tuple[str, ...] = ()
    model: Model = NOTHING
    rigs: tuple = (TABLE_1,)

    @property
    def free(self):
        return [SimpleNamespace(name=name) for name in self.names]

    @property
    def chosen(self):
        return range(len(self.names))

    @property
    def problem(self):
        unknowns = [SimpleNamespace(name=name) for name in ("preload_N", *self.further)]
        return SimpleNamespace(fixed=Model(()), runs=(), unknowns=unknowns)


@pytest.fixture(autouse=True)
def linear(monkeypatch):
    def residuals_with(fit, values):
        moved = 0.0
        for name, value in values.items():
            usual = TABLE_1.bristles.stiffness_N_per_mm if name == d.STIFFNESS else 1.0
            if name == d.EXCESS:
                moved += value
            elif name == d.STIFFNESS:
                moved += np.log(value / usual)
        return fit.left + moved * fit.per_e

    monkeypatch.setattr(d, "residuals_with", residuals_with)
    monkeypatch.setattr(d, "slopes_of_free", lambda fit: SLOPES)
    monkeypatch.setattr(d, "moved_model", lambda fit, moves: Model(()))


def look(saves, stiffness=1e4, moves=(0.0, 0.0)):
    return d.Look({d.STIFFNESS: stiffness}, np.array(moves), saves)


def solved(estimates=(), further=(d.STIFFNESS, d.VISCOUS)):
    return d.Solved(Fit(OWN, further=further, model=Model(tuple(estimates))), None)


@pytest.fixture
def again(monkeypatch):
    """Fits that would follow: what each was asked for, and what it answers."""
    asked, answers = [], []

    def fit(initial, fixed, runs, further, step):
        asked.append((initial, fixed, further))
        return answers.pop() if answers else "fitted"

    monkeypatch.setattr(d, "_solved", fit)
    return asked, answers


def estimate(name, value, low, high, *, stderr=1.0, at_bound=False):
    return Estimate(name, value, QUANTITIES[name].unit, "fitted", None, stderr, low, high, at_bound)


def test_the_stiffness_is_sought_again_from_where_it_fits_best(again):
    better = d.Solved(Fit(-np.log(5.0) * OWN, further=(d.STIFFNESS,)), None)
    assert d._from_better_stiffness(better, SILENT) == "fitted"
    ((initial, fixed, further),) = again[0]
    assert initial.value(d.STIFFNESS) == fixed.value(d.STIFFNESS) == pytest.approx(25e3)
    assert further == [d.STIFFNESS]


def test_a_stiffness_that_is_free_or_gains_little_stays(again):
    free = d.Solved(Fit(-np.log(5.0) * OWN, names=(d.STIFFNESS,)), None)
    assert d._from_better_stiffness(free, SILENT) is None
    little = d.Solved(Fit(-0.4 * OWN), None)  # saves 16 of 25 at the most
    assert d._from_better_stiffness(little, SILENT) is None
    assert again[0] == []


FINEST = TABLE_1.tendon_stiffness_N * LUMPS**2 / TABLE_1.sheath_length_mm


@pytest.mark.parametrize(
    ("value", "low", "high", "at"),
    [
        (5e3, 4e3, 6e3, None),  # identifiable
        (5e3, 100.0, 9.9e3, None),  # just so
        (5e3, 100.0, 10.1e3, 5e3),  # by its name alone
        (2.0 * FINEST, FINEST, 3.0 * FINEST, FINEST),  # finer than the mesh
    ],
)
def test_a_stiffness_that_is_vague_or_too_fine_is_fixed(again, value, low, high, at):
    others = [estimate(d.VISCOUS, 0.02, 0.001, 10.0), estimate(d.STIFFNESS, value, low, high)]
    found = d._at_stiffness(solved(estimates=others), SILENT)
    if at is None:
        assert found is None
        assert again[0] == []
    else:
        assert found == "fitted"
        ((initial, fixed, further),) = again[0]
        assert initial.value(d.STIFFNESS) == fixed.value(d.STIFFNESS) == pytest.approx(at)
        assert further == [d.VISCOUS]


def test_a_stiffness_without_interval_is_left_alone(again):
    alone = [Estimate(d.STIFFNESS, 5e3, "N/mm", "default")]
    assert d._at_stiffness(solved(estimates=alone), SILENT) is None


def freed(*, low=0.1, stderr=1.0, at_bound=False):
    lasting = estimate(d.STIFFNESS, 1e4, low, 2e4, stderr=stderr, at_bound=at_bound)
    return solved(estimates=[lasting])


@pytest.mark.parametrize(
    ("more", "kept"),
    [
        (freed(), True),
        (freed(low=1e-2), False),  # its interval reaches to the bound
        (freed(stderr=None), False),
        (freed(at_bound=True), False),
        (solved(), False),  # not told at all
        (None, False),
    ],
)
def test_what_is_freed_stays_free_where_it_is_told(again, more, kept):
    again[1].append(more)
    found = d._freed(solved(), [look(10.0), look(30.0, 1e4)], SILENT)
    assert (found is more) == kept or more is None
    assert (found is None) != kept
    assert again[0][0][2] == [d.STIFFNESS, d.VISCOUS, d.STIFFNESS]


def test_what_saves_too_little_is_not_freed(again):
    assert d._freed(solved(), [look(24.9), look(3.0)], SILENT) is None
    assert again[0] == []


def test_errors_are_widened_by_the_largest_move_in_units_of_student():
    from tsas_cli.identification.fit import Fitted

    fitted = Fitted(
        np.zeros(2), np.array([3.0, 1.0]), np.array([2.0, 2.5]), np.zeros(2, bool), True, "", 1
    )
    like = [look(0.0, moves=(8.0, 0.0)), look(0.0, moves=(-2.0, 0.0))]
    assert d._widened(fitted, like).stderr.tolist() == [5.0, 1.0]  # 3, 4, 5
    assert d._widened(fitted, []).stderr.tolist() == [3.0, 1.0]
