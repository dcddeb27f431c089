"""What the fit of the dynamic model tries, frees and fixes, on residuals that are made up."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.identification.test_dynamic_fit import VISCOUS
from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.response import LUMPS
from tsas_cli.physics.rig import with_values
from tsas_cli.support.steps import NO_PROGRESS

SPEED = np.geomspace(0.01, 100.0, 400)  # a hundred samples in each decade
SLOPES = np.column_stack((np.log(SPEED), np.cos(np.arange(400.0))))
OFF = np.array([0.4, -0.2])  # of the free parameters
DAMPED = with_values(TABLE_1, {"bristles.damping_N_s_per_mm": 7.0})


def at_rest(velocity):
    return 10.0 * np.exp(-SPEED / velocity)


def made(monkeypatch, lacks, **known):
    """Return a fit, off by its free parameters and by what it lacks; excesses wear off."""
    residual = SLOPES @ OFF - lacks

    def residuals_with(_, changes):
        excess = changes.get(d.EXCESS, 0.0)
        own = at_rest(changes.get(d.VELOCITY, 1.0)) * excess / (1.0 + 5.0 * excess)
        values = [(changes[n], v) for n, v in known.items() if n in changes]
        return residual + own + sum(np.sin(SPEED) * math.log(at / v) for at, v in values)

    monkeypatch.setattr(d, "residuals_with", residuals_with)
    monkeypatch.setattr(d, "slopes_of_free", lambda _: SLOPES)
    return SimpleNamespace(rigs=[TABLE_1, DAMPED]), float(residual @ residual)


def test_friction_at_rest_is_screened_over_its_velocity(monkeypatch):
    """At the right one nothing is left; a tenth shows where ten deviations of it are its own."""
    fit, squares = made(monkeypatch, 0.3 * at_rest(1.0))
    looks = d._friction_at_rest(fit, NO_PROGRESS)
    best = max(looks, key=lambda look: look.saves)
    assert best.values[d.VELOCITY] == pytest.approx(1.0)
    assert best.values[d.EXCESS] == pytest.approx(0.3, rel=0.01)
    assert best.moves == pytest.approx(-OFF, abs=1e-6)
    assert best.saves == pytest.approx(squares)
    beside = np.eye(400) - SLOPES @ np.linalg.pinv(SLOPES)
    shown = [0.1 / 1.5 * np.linalg.norm(beside @ at_rest(v)) > 10.0 for v in d.VELOCITIES]
    assert [look.shows for look in looks] == shown
    assert 3 < sum(shown) < 14
    said = d._static_friction_note(looks)
    ends = d.VELOCITIES[shown][[0, -1]]
    assert f"10% more friction at rest would be visible for velocities of {ends[0]:.2g} to " in said
    assert f" to {ends[1]:.3g} mm/s;" in said
    assert d._static_friction_note(looks[:1]).endswith("recordings, whatever their values.")


@pytest.mark.parametrize(("lacks", "begins"), [(-0.3, 0.01), (5.0, 1.0)])
def test_friction_at_rest_begins_within_its_range_and_is_never_less(monkeypatch, lacks, begins):
    fit, _ = made(monkeypatch, lacks * at_rest(1.0))
    looks = d._friction_at_rest(fit, NO_PROGRESS)
    assert looks[8].values == pytest.approx({d.EXCESS: begins, d.VELOCITY: 1.0})
    assert (looks[8].saves == 0.0) == (lacks < 0.0)


@pytest.mark.parametrize(
    ("name", "usual", "true"),
    [
        (d.STIFFNESS, TABLE_1.bristles.stiffness_N_per_mm, 0.05),
        (d.DAMPING, max(7.0, bristles_of(TABLE_1).damping), 5.0),
        (VISCOUS, 0.02, 100.0),
    ],
)
def test_a_fixed_value_is_screened_from_its_usual_one(monkeypatch, name, usual, true):
    lacks = np.sin(SPEED) * math.log(true)
    fit, squares = made(monkeypatch, lacks, **{name: usual})
    looks = d._sizes(fit, name, NO_PROGRESS)
    tried = np.array([look.values[name] for look in looks]) / usual
    times = [t * 10.0**k for k in range(3) for t in (1.0, 2.0, 5.0)][:7]
    below = [1.0 / t for t in times] if name == d.STIFFNESS else []
    assert tried == pytest.approx([*times, *below])
    best = max(looks, key=lambda look: look.saves)
    assert best.values[name] == pytest.approx(true * usual)
    assert best.moves == pytest.approx(-OFF)
    assert best.saves == pytest.approx(squares)
    note = d._indistinguishable_note(name, looks[:3])
    lowest = f"{usual:.2g}" if name == d.STIFFNESS else "0"
    assert f"{name} is not identifiable: {lowest} to {5.0 * usual:.2g} N" in note


def test_errors_hold_the_moves_of_all_values_that_fit_as_well():
    """A standard error of 3 and a move of 8 over a t of 2 are 5."""
    none = np.zeros(2, dtype=bool)
    fitted = Fitted(np.zeros(2), np.array([3.0, 1.0]), np.array([2.0, 2.0]), none, True, "", 1)
    looks = [d.ScreenedValue({}, np.array(moves), 0.0) for moves in ((1.0, 0.0), (-8.0, 0.0))]
    assert d._widened(fitted, looks).stderr == pytest.approx([5.0, 1.0])


def freed(monkeypatch, saves=26.0, **changed):
    """Return whether a damping is freed that is found at 3 [1, 9]."""
    found = {"stderr": 1.0, "interval_low": 1.0, "interval_high": 9.0} | changed
    estimate = Estimate(d.DAMPING, 3.0, "N s/mm", "fitted", **found)
    more = SimpleNamespace(model=Model((estimate,)))
    monkeypatch.setattr(d, "_solved_again", lambda *_: more)
    fit = SimpleNamespace(problem=SimpleNamespace(fixed=Model(()), unknowns=[]))
    looks = [d.ScreenedValue({d.DAMPING: v}, OFF, s) for v, s in ((1.0, 0.0), (2.0, saves))]
    return d._freed(fit, looks, NO_PROGRESS) is more


def test_a_value_is_freed_that_saves_much_and_is_found_within_its_bounds(monkeypatch):
    assert freed(monkeypatch)
    for how in (
        *({"saves": 24.0}, {"stderr": None}, {"interval_low": None}, {"at_bound": True}),
        {"interval_low": 1e-6},
    ):
        assert not freed(monkeypatch, **how)


@pytest.mark.parametrize(
    ("low", "value", "high", "at"),
    [
        (1.0, 5.0, 99.0, None),
        (1.0, 5.0, 101.0, 5.0),  # an interval that tells nothing
        (0.9, 1.0, 1.1, "finest"),
        (None, 5.0, 99.0, None),
    ],
)
def test_a_stiffness_is_fixed_where_it_is_vague_or_bends_within_a_lump(
    monkeypatch, low, value, high, at
):
    """With the finest one √(EA L/σ0) is the length of a lump."""
    finest = d._finest_stiffness(SimpleNamespace(rigs=[TABLE_1]))
    L = TABLE_1.sheath_length_mm
    assert math.sqrt(TABLE_1.tendon_stiffness_N * L / finest) == pytest.approx(L / LUMPS)
    unit = 1.01 * finest if at == "finest" else 1e-3 * finest
    low, value, high = (None if v is None else unit * v for v in (low, value, high))
    e = Estimate(d.STIFFNESS, value, "N/mm", "fitted", None, 1.0, low, high)
    unknowns = [SimpleNamespace(name=n) for n in ("preload_N", d.STIFFNESS, VISCOUS)]
    fit = SimpleNamespace(
        rigs=[TABLE_1],
        model=Model((e,)),
        chosen=(0, 1),
        problem=SimpleNamespace(fixed=Model(()), unknowns=unknowns),
    )
    monkeypatch.setattr(d, "_solved_again", lambda fit, look, fixed, further, _: (fixed, further))
    found = d._at_stiffness(fit, NO_PROGRESS)
    if at is None:
        assert found is None
    else:
        fixed, further = found
        expected = finest if at == "finest" else unit * at
        assert fixed.value(d.STIFFNESS, None) == pytest.approx(expected)
        assert further == [VISCOUS]
