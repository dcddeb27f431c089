"""What the dynamic fit tries before it frees anything, on fits whose residuals are linear."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
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


def test_a_value_that_fits_better_saves_what_the_others_leave():
    """Twice the stiffness takes ln 2 of its errors away; what the others can do is done by them."""
    left = -np.log(2.0) * OWN + SLOPES @ [3.0, -4.0]
    looks = d._sizes(Fit(left), d.STIFFNESS, SILENT)
    by = {round(look.values[d.STIFFNESS] / 5000.0, 6): look for look in looks}
    assert set(by) == {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01}
    assert by[2.0].saves == pytest.approx(left @ left)
    np.testing.assert_allclose(by[2.0].moves, [-3.0, 4.0], atol=1e-9)
    assert by[1.0].saves == pytest.approx(25.0)
    assert max(looks, key=lambda look: look.saves) is by[2.0]


def test_others_are_looked_at_from_the_usual_size_up():
    looks = d._sizes(Fit(OWN), d.VISCOUS, SILENT)
    usual = QUANTITIES[d.VISCOUS].size
    assert [look.values[d.VISCOUS] / usual for look in looks] == pytest.approx(list(d.TIMES))


@pytest.mark.parametrize(("asked", "started"), [(0.3, 0.3), (5.0, 1.0), (0.001, 0.01)])
def test_friction_at_rest_is_looked_at_at_the_size_that_is_asked_for(asked, started):
    looks = d._friction_at_rest(Fit(-asked * OWN), SILENT)
    assert [look.values[d.VELOCITY] for look in looks] == pytest.approx(list(d.VELOCITIES))
    for look in looks:
        assert look.values[d.EXCESS] == pytest.approx(started)
        assert look.saves == pytest.approx(100.0 * asked**2)


def test_less_friction_at_rest_is_none():
    looks = d._friction_at_rest(Fit(0.5 * OWN), SILENT)
    assert {look.saves for look in looks} == {0.0}
    assert {look.values[d.EXCESS] for look in looks} == {0.01}


@pytest.mark.parametrize(("size", "shows"), [(99.0, False), (101.0, True)])
def test_what_would_show_is_ten_times_noise_at_a_tenth_more_friction(size, shows):
    looks = d._friction_at_rest(Fit(np.zeros(50), size / 10.0 * OWN), SILENT)
    assert {look.shows for look in looks} == {shows}
    imitated = Fit(np.zeros(50), 1e3 * SLOPES[:, 0])
    assert not any(look.shows for look in d._friction_at_rest(imitated, SILENT))


def look(saves, stiffness=1e4, moves=(0.0, 0.0)):
    return d.Look({d.STIFFNESS: stiffness}, np.array(moves), saves)


def test_what_would_have_shown_is_said():
    shown = [
        d.Look({d.EXCESS: 0.1, d.VELOCITY: v}, np.zeros(2), 0.0, shows)
        for v, shows in ((0.01, False), (0.5, True), (7.0, True), (100.0, False))
    ]
    assert "velocity were 0.5 to 7 mm/s" in d._unseen_rest(shown)
    assert "10% more friction" in d._unseen_rest(shown)
    assert d._unseen_rest(shown[:1]).endswith("whatever they are.")


def test_values_that_fit_alike_are_said():
    like = [look(1.0, 2e3), look(2.0, 5e4), look(1.5, 1e4)]
    assert d._alike(d.STIFFNESS, like).startswith(
        f"{d.STIFFNESS} is not told: 2e+03 to 5e+04 N/mm fit alike"
    )
    viscous = [d.Look({d.VISCOUS: v}, np.zeros(2), 0.0) for v in (0.01, 0.2)]
    assert d._alike(d.VISCOUS, viscous).startswith(f"{d.VISCOUS} is not told: 0 to 0.2 N s/mm")


def test_what_is_looked_at():
    """Stribeck velocities from 0.01 to 100 mm/s, four for each ten times as fast."""
    assert d.VELOCITIES[[0, 4, 8, 12, 16]] == pytest.approx([0.01, 0.1, 1.0, 10.0, 100.0])
    assert d.VELOCITIES.size == 17
    assert d.TIMES == (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)


def test_the_finest_stiffness_reaches_as_far_as_a_lump_is_long():
    """√(EA L/σ0) is L/LUMPS there."""
    fit = SimpleNamespace(rigs=[TABLE_1, "another"])
    length = TABLE_1.sheath_length_mm
    reach = np.sqrt(TABLE_1.tendon_stiffness_N * length / d._finest_stiffness(fit))
    assert reach == pytest.approx(length / LUMPS)


def test_moves_that_are_asked_for_take_errors_away():
    slopes = np.array([[1.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    assert d._asked(slopes, np.array([3.0, -4.0, 7.0])) == pytest.approx([-3.0, 2.0])


def test_values_to_start_from_have_their_units():
    (one, two) = d._model_of({d.STIFFNESS: 5.0, d.EXCESS: 0.2}).estimates
    assert (one.name, one.value, one.unit, one.origin) == (d.STIFFNESS, 5.0, "N/mm", "default")
    assert (two.name, two.value, two.unit) == (d.EXCESS, 0.2, QUANTITIES[d.EXCESS].unit)


def test_only_names_that_are_free_are_free():
    fit = SimpleNamespace(free=[SimpleNamespace(name=d.VISCOUS)])
    assert d._is_free(fit, d.VISCOUS)
    assert not d._is_free(fit, d.STIFFNESS)
