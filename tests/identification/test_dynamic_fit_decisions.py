"""What the dynamic fit tries, and what it frees, fixes or seeks again, on fits that are linear."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.physics.response import LUMPS
from tsas_cli.support.steps import NO_PROGRESS

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


def test_a_value_that_fits_better_saves_what_the_others_leave():
    """Twice the stiffness takes ln 2 of its errors away; what the others can do is done by them."""
    left = -np.log(2.0) * OWN + SLOPES @ [3.0, -4.0]
    looks = d._sizes(Fit(left), d.STIFFNESS, NO_PROGRESS)
    by = {round(look.values[d.STIFFNESS] / 5000.0, 6): look for look in looks}
    assert set(by) == {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01}
    assert by[2.0].saves == pytest.approx(left @ left)
    np.testing.assert_allclose(by[2.0].moves, [-3.0, 4.0], atol=1e-9)
    assert by[1.0].saves == pytest.approx(25.0)
    assert max(looks, key=lambda look: look.saves) is by[2.0]


@pytest.mark.parametrize(
    ("asked", "started"), [(0.3, 0.3), (5.0, 1.0), (0.001, 0.01), (-0.5, 0.01)]
)
def test_friction_at_rest_is_looked_at_at_the_size_that_is_asked_for(asked, started):
    """Less of it is none."""
    looks = d._friction_at_rest(Fit(-asked * OWN), NO_PROGRESS)
    assert [look.values[d.VELOCITY] for look in looks] == pytest.approx(list(d.VELOCITIES))
    for look in looks:
        assert look.values[d.EXCESS] == pytest.approx(started)
        assert look.saves == pytest.approx(100.0 * max(asked, 0.0) ** 2)


@pytest.mark.parametrize(("size", "shows"), [(99.0, False), (101.0, True)])
def test_what_would_show_is_ten_times_noise_at_a_tenth_more_friction(size, shows):
    looks = d._friction_at_rest(Fit(np.zeros(50), size / 10.0 * OWN), NO_PROGRESS)
    assert {look.shows for look in looks} == {shows}
    imitated = Fit(np.zeros(50), 1e3 * SLOPES[:, 0])
    assert not any(look.shows for look in d._friction_at_rest(imitated, NO_PROGRESS))


def look(saves, moves=(0.0, 0.0)):
    return d.ScreenedValue({d.STIFFNESS: 1e4}, np.array(moves), saves)


def test_what_would_have_shown_is_said():
    shown = [
        d.ScreenedValue({d.EXCESS: 0.1, d.VELOCITY: v}, np.zeros(2), 0.0, shows)
        for v, shows in ((0.01, False), (0.5, True), (7.0, True), (100.0, False))
    ]
    assert "velocities of 0.5 to 7 mm/s" in d._static_friction_note(shown)
    assert "10% more friction" in d._static_friction_note(shown)
    assert d._static_friction_note(shown[:1]).endswith("whatever their values.")


def test_the_finest_stiffness_reaches_as_far_as_a_lump_is_long():
    """√(EA L/σ0) is L/LUMPS there."""
    length = TABLE_1.sheath_length_mm
    reach = np.sqrt(TABLE_1.tendon_stiffness_N * length / d._finest_stiffness(Fit(OWN)))
    assert reach == pytest.approx(length / LUMPS)


def solved(estimates=(), further=(d.STIFFNESS, d.VISCOUS)):
    return Fit(OWN, further=further, model=Model(tuple(estimates)))


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
    better = Fit(-np.log(5.0) * OWN, further=(d.STIFFNESS,))
    assert d._from_better_stiffness(better, NO_PROGRESS) == "fitted"
    ((initial, fixed, further),) = again[0]
    assert initial.value(d.STIFFNESS) == fixed.value(d.STIFFNESS) == pytest.approx(25e3)
    assert further == [d.STIFFNESS]


def test_a_stiffness_that_is_free_or_gains_little_stays(again):
    free = Fit(-np.log(5.0) * OWN, names=(d.STIFFNESS,))
    assert d._from_better_stiffness(free, NO_PROGRESS) is None
    little = Fit(-0.4 * OWN)  # saves 16 of 25 at the most
    assert d._from_better_stiffness(little, NO_PROGRESS) is None
    assert again[0] == []


FINEST = d._finest_stiffness(Fit(OWN))


@pytest.mark.parametrize(
    ("value", "low", "high", "at"),
    [
        (5e3, 4e3, 6e3, None),  # identifiable
        (5e3, 100.0, 9.9e3, None),  # just so
        (5e3, 100.0, 10.1e3, 5e3),  # by its name alone
        (2.0 * FINEST, FINEST, 3.0 * FINEST, FINEST),  # finer than the mesh
        (5e3, None, None, None),  # not fitted
    ],
)
def test_a_stiffness_that_is_vague_or_too_fine_is_fixed(again, value, low, high, at):
    others = [estimate(d.VISCOUS, 0.02, 0.001, 10.0), estimate(d.STIFFNESS, value, low, high)]
    found = d._at_stiffness(solved(estimates=others), NO_PROGRESS)
    if at is None:
        assert found is None
        assert again[0] == []
    else:
        assert found == "fitted"
        ((initial, fixed, further),) = again[0]
        assert initial.value(d.STIFFNESS) == fixed.value(d.STIFFNESS) == pytest.approx(at)
        assert further == [d.VISCOUS]


def freed(low=0.1, **how):
    return solved(estimates=[estimate(d.STIFFNESS, 1e4, low, 2e4, **how)])


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
    found = d._freed(solved(), [look(10.0), look(30.0)], NO_PROGRESS)
    assert (found is more) == kept or more is None
    assert (found is None) != kept
    assert again[0][0][2] == [d.STIFFNESS, d.VISCOUS, d.STIFFNESS]


def test_what_saves_too_little_is_not_freed(again):
    assert d._freed(solved(), [look(24.9), look(3.0)], NO_PROGRESS) is None
    assert again[0] == []


def test_errors_are_widened_by_the_largest_move_in_units_of_student():
    fitted = Fitted(
        np.zeros(2), np.array([3.0, 1.0]), np.array([2.0, 2.5]), np.zeros(2, bool), True, "", 1
    )
    like = [look(0.0, moves=(8.0, 0.0)), look(0.0, moves=(-2.0, 0.0))]
    assert d._widened(fitted, like).stderr.tolist() == [5.0, 1.0]  # 3, 4, 5
    assert d._widened(fitted, []).stderr.tolist() == [3.0, 1.0]
