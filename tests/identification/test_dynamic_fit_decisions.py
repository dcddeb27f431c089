"""What the dynamic fit tries, and what it frees, fixes or seeks again, on fits that are linear."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
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


def test_errors_are_widened_by_the_largest_move_in_units_of_student():
    fitted = Fitted(
        np.zeros(2), np.array([3.0, 1.0]), np.array([2.0, 2.5]), np.zeros(2, bool), True, "", 1
    )
    like = [look(0.0, moves=(8.0, 0.0)), look(0.0, moves=(-2.0, 0.0))]
    assert d._widened(fitted, like).stderr.tolist() == [5.0, 1.0]  # 3, 4, 5
    assert d._widened(fitted, []).stderr.tolist() == [3.0, 1.0]
