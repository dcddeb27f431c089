"""Signatures seen linearly: what free parameters can imitate, and how much of the rest is asked."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.effects import FREE_TENDON, STRIBECK_FRICTION
from tsas_cli.identification.fit import Unknown
from tsas_cli.identification.screening import projector, refined, screen, screen_again

RNG = np.random.default_rng(7)
N = 60
FREE = RNG.standard_normal((N, 3))


def trial_of(residual=None, *, at_bound=(False, False, False), jacobian=FREE):
    unknowns = [
        Unknown(n, None, 0.0, -1.0, 1.0, s) for n, s in zip("abc", (1.0, 5.0, 0.2), strict=True)
    ]
    solution = SimpleNamespace(jacobian=jacobian, at_bound=np.array(at_bound), residual=residual)
    return SimpleNamespace(unknowns=unknowns, solution=solution)


def test_the_basis_spans_what_the_free_parameters_do():
    basis = projector(trial_of())
    np.testing.assert_allclose(basis.T @ basis, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(basis @ (basis.T @ FREE), FREE, atol=1e-12)
    bound = projector(trial_of(at_bound=(False, True, False)))
    assert bound.shape == (N, 2)
    left = FREE[:, 1] - bound @ (bound.T @ FREE[:, 1])
    assert left @ left > 1.0


def test_what_does_the_same_as_another_adds_no_direction():
    twice = FREE.copy()
    twice[:, 2] = 2.0 * twice[:, 0] - twice[:, 1]
    assert projector(trial_of(jacobian=twice)).shape == (N, 2)


OWN = 8.0 * np.linalg.qr(RNG.standard_normal((N, 2)))[0]


class Bench:
    """Effects whose errors are linear in their amplitudes, in units of their usual sizes."""

    def __init__(self, effect, shape=None):
        self.effect, self.shape = effect, shape

    def errors_at(self, trial, values):
        out = np.array(trial.solution.residual)
        amplitudes = [p for p in self.effect.parameters if not p.shape]
        for k, p in enumerate(amplitudes):
            value = values.get(f"{self.effect.name}.{p.name}", p.neutral)
            matches = self.shape is None or self.shape in values.values()
            out = out + (value - p.neutral) / (p.start - p.neutral) * OWN[:, k] * matches
        return out


def test_the_amounts_are_those_that_take_the_residual_away():
    """Two of one length, half of the other: what is seen, less what free parameters do, is all."""
    residual = -(2.0 * OWN[:, 0] + 0.5 * OWN[:, 1]) + FREE @ [1.0, -2.0, 0.5]
    basis = projector(trial_of())
    residual -= basis @ (basis.T @ residual)  # as a fit leaves it
    found = screen(Bench(FREE_TENDON), trial_of(residual), FREE_TENDON, basis)
    assert found.part == pytest.approx(1.0, abs=1e-6)
    starts = {f"free_tendon.{p.name}": p.start for p in FREE_TENDON.parameters}
    amounts = dict(zip(starts, (2.0, 0.5), strict=True))
    assert found.initial == pytest.approx({n: amounts[n] * starts[n] for n in starts}, rel=1e-4)
    own = OWN - basis @ (basis.T @ OWN)
    np.testing.assert_allclose(found.signatures, own, atol=1e-9)
    np.testing.assert_allclose(found.change, 2.0 * OWN[:, 0] + 0.5 * OWN[:, 1], atol=1e-3)


def test_known_changes_are_screened_again_without_a_simulation_and_refined_by_one():
    """At another trial the same changes explain another residual; a third of them, after one."""
    residual = -(2.0 * OWN[:, 0] + 0.5 * OWN[:, 1])
    basis = np.zeros((N, 0))
    known = screen(Bench(FREE_TENDON), trial_of(residual), FREE_TENDON, basis)
    other = trial_of(-OWN[:, 1])
    again = screen_again(known, other, basis)
    assert again.part == pytest.approx(1.0, abs=1e-6)
    _, distal = FREE_TENDON.parameters
    assert again.initial[f"free_tendon.{distal.name}"] == pytest.approx(distal.start, rel=1e-4)

    class Weaker(Bench):
        def errors_at(self, trial, values):
            full = super().errors_at(trial, values)
            return trial.solution.residual + (full - trial.solution.residual) / 3.0

    anew = refined(Weaker(FREE_TENDON), other, again, basis)
    three = pytest.approx(3.0 * distal.start, rel=1e-4)
    assert anew.initial[f"free_tendon.{distal.name}"] == three
    np.testing.assert_allclose(anew.changes[anew.values], OWN / 3.0, atol=1e-9)


def test_a_length_cannot_be_negative_nor_ten_times_the_plausible_one():
    trial = trial_of(OWN[:, 0] - 25.0 * OWN[:, 1])
    found = screen(Bench(FREE_TENDON), trial, FREE_TENDON, np.zeros((N, 0)))
    proximal, distal = (p.start for p in FREE_TENDON.parameters)
    values = list(found.initial.values())
    assert values[0] == pytest.approx(0.0, abs=1e-5 * proximal)
    assert values[1] == pytest.approx(10.0 * distal, rel=1e-5)
    assert 0.0 < found.part < 1.0


def test_the_best_shape_is_taken():
    shape = next(p for p in STRIBECK_FRICTION.parameters if p.shape)
    assert len(shape.starts) > 2
    right = shape.starts[-2]
    trial = trial_of(-0.3 * OWN[:, 0])
    found = screen(Bench(STRIBECK_FRICTION, right), trial, STRIBECK_FRICTION, np.zeros((N, 0)))
    assert found.initial[f"stribeck_friction.{shape.name}"] == right
    assert found.part == pytest.approx(1.0, abs=1e-6)


def test_what_explains_nothing_has_no_part():
    residual = RNG.standard_normal(N)
    basis = np.linalg.qr(OWN)[0]
    residual -= basis @ (basis.T @ residual)
    found = screen(Bench(FREE_TENDON), trial_of(residual), FREE_TENDON, np.zeros((N, 0)))
    assert found.part == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("known", [True, False])
def test_what_cannot_be_simulated_explains_nothing(known):
    """Before, a decomposition of such signatures that failed ended the calibration."""
    shape = next(p for p in STRIBECK_FRICTION.parameters if p.shape)
    lost = shape.starts[1:] if known else shape.starts

    class Lost(Bench):
        def errors_at(self, trial, values):
            out = super().errors_at(trial, values)
            return np.where(set(lost) & set(values.values()), np.nan, out)

    bench = Lost(STRIBECK_FRICTION, shape.starts[0])
    found = screen(bench, trial_of(-0.3 * OWN[:, 0]), STRIBECK_FRICTION, np.zeros((N, 0)))
    assert found.part == pytest.approx(float(known), abs=1e-6)
    assert bool(found.initial) == known
