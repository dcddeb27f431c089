"""The slip chain against the closed form, against a profile, and against a relaxed chain."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import GROUP_A, Profile, relaxed_chain, wrap_of
from tests.rig import tendon
from tests.rig.motions import Motion
from tsas_cli.effects import Effects, FreeTendon
from tsas_cli.physics.branches import branches
from tsas_cli.physics.slip_chain import DISPLACEMENT, FORCE, Boundary, slip_chain

A = wrap_of(GROUP_A)
UP = math.exp(A)
FREE = GROUP_A._replace(effects=Effects(FreeTendon(152.0, 61.0)))
SPRING = Boundary(DISPLACEMENT, DISPLACEMENT, 1.0 / GROUP_A.load_stiffness_N_per_mm)
LOADED_BY_FORCE = Boundary(DISPLACEMENT, FORCE, 0.0)
LOADED_BY_DISPLACEMENT = Boundary(DISPLACEMENT, DISPLACEMENT, 0.0)
DRIVEN_BY_FORCE = Boundary(FORCE, DISPLACEMENT, 1.0 / GROUP_A.load_stiffness_N_per_mm)


def follow(drive, *, load=None, rig=GROUP_A, boundary=SPRING, n=30, wrap=None, preload=None):
    drive = np.asarray(drive, dtype=float)
    load = np.zeros_like(drive) if load is None else np.asarray(load, dtype=float)
    wrap = np.array([wrap_of(rig)]) if wrap is None else wrap
    preload = np.array([rig.preload_N]) if preload is None else preload
    return slip_chain(drive, load, wrap, preload, rig, boundary, n)


def through(*turns, samples=400):
    """Go from rest to each turn in evenly spaced samples."""
    legs = [np.linspace(a, b, samples + 1)[1:] for a, b in pairwise((0.0, *turns))]
    return np.concatenate(legs)


NESTED = through(20.0, 5.0, 15.0, 8.0, 11.0, 8.0, 15.0, 5.0, 20.0, 19.9, 19.95, 19.8, 0.0)


@pytest.mark.parametrize(("direction", "slope"), [(1, 2.287), (-1, 1.050)])
def test_slopes_of_full_slip(direction, slope):
    x_in, _, f_in, f_out, phase = follow(through(20.0, 0.0))
    slipping = phase == direction
    assert slipping.sum() > 300
    fit = np.polyfit(x_in[slipping], f_in[slipping], 1)[0]
    assert fit == pytest.approx(slope, abs=5e-4)
    np.testing.assert_allclose(f_in[slipping] / f_out[slipping], UP**direction, rtol=1e-9)


@pytest.mark.parametrize(
    ("motion", "rms_order"),
    [
        pytest.param(np.linspace(20.0, 19.75, 200001), 1.8, id="constant speed"),
        pytest.param(10.0 + 10.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 40001)), 1.45, id="sine"),
    ],
)
def test_order_of_the_mesh(motion, rms_order):
    """Second order but for the reversals, where the exact slope is infinite and the largest
    error falls with 1/n; a sine spends more of its samples there."""
    exact = branches(motion, GROUP_A)[0]
    errors = [follow(motion, n=n)[2] - exact for n in (10, 20, 40, 80, 160)]
    rms = [math.sqrt(np.mean(e**2)) for e in errors]
    largest = [np.abs(e).max() for e in errors]
    assert math.log2(rms[0] / rms[-1]) / 4.0 > rms_order
    assert 0.95 < math.log2(largest[0] / largest[-1]) / 4.0 < 1.1


def test_full_slip_is_second_order():
    exact = branches(np.array([20.0]), GROUP_A)[0][0]
    errors = [abs(follow([20.0], n=n)[2][0] - exact) for n in (10, 20, 40, 80, 160)]
    assert errors[0] < 1e-3
    for coarse, fine in pairwise(errors):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("rig", [GROUP_A, FREE])
def test_nested_partial_reversals_are_those_of_the_closed_form(rig):
    exact_in, exact_out, _ = branches(NESTED, rig)
    _, x_out, f_in, f_out, phase = follow(NESTED, rig=rig, n=100)
    assert np.sqrt(np.mean((f_in - exact_in) ** 2)) < 0.02
    assert np.abs(f_out - exact_out).max() < 0.02
    np.testing.assert_allclose(f_out, 25.0 + 1.579 * x_out, rtol=1e-12)
    assert set(phase) == {-1, 0, 1}


@pytest.mark.parametrize("turns", [(20.0, 20.0 - 0.4), (0.0, 0.4)])
def test_end_tangents_and_secant_of_the_dead_band(turns):
    """The band ends with 70.6 N/mm (unloading) or 104.5 N/mm (reloading); 175.10 over all."""
    pulling = turns[1] > turns[0]
    before = through(20.0, turns[0]) if pulling else through(turns[0])
    motion = np.concatenate((before, np.linspace(*turns, 20001)))
    x, _, f_in, f_out, _ = (column[before.size :] for column in follow(motion, n=200))
    last = int(np.argmax(np.abs(f_out - f_out[0]) > 1e-6)) - 1
    secant = (f_in[last] - f_in[0]) / (x[last] - x[0])
    assert secant == pytest.approx(175.10, rel=5e-3)
    late = slice(int(0.97 * last), last)
    tangent = np.polyfit(x[late], f_in[late], 1)[0]
    assert tangent == pytest.approx(104.5 if pulling else 70.6, rel=0.02)


def test_return_point_memory():
    plain = follow([20.0, 19.95, 19.8])[2]
    looped = follow([20.0, 19.95, 19.98, 19.96, 19.97, 19.95, 19.8])[2]
    assert looped[[0, 1, 5, 6]] == pytest.approx(plain[[0, 1, 1, 2]], rel=1e-8)
    assert looped[2] > looped[1] + 1.0


@pytest.mark.parametrize("rig", [GROUP_A, FREE])
@pytest.mark.parametrize("boundary", [LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT])
def test_the_spring_run_fed_back_as_a_load_repeats_itself(rig, boundary):
    spring = follow(NESTED, rig=rig)
    load = spring[3] if boundary == LOADED_BY_FORCE else spring[1]
    again = follow(NESTED, load=load, rig=rig, boundary=boundary)
    for before, after in zip(spring[:4], again[:4], strict=True):
        np.testing.assert_allclose(after, before, atol=1e-6)
    assert not (again[4] == 3).any()


def test_the_tension_at_the_drive_fed_back_repeats_the_motion():
    spring = follow(NESTED, rig=FREE)
    again = follow(spring[2], rig=FREE, boundary=DRIVEN_BY_FORCE)
    for before, after in zip(spring[:4], again[:4], strict=True):
        np.testing.assert_allclose(after, before, atol=1e-6)


def test_a_drive_by_force_moves_as_the_profile_says():
    turns = 25.0 * np.array([2.0, 0.9, 1.7, 1.1, 0.4, 3.0])
    profile, exact = Profile(FREE), []
    for f_in in turns:
        profile.pull_drive_to(f_in)
        exact.append((profile.x_in, profile.x_out))
    x_in, x_out, f_in, _, _ = follow(turns, rig=FREE, boundary=DRIVEN_BY_FORCE, n=200)
    np.testing.assert_array_equal(f_in, turns)
    np.testing.assert_allclose(np.transpose(exact), [x_in, x_out], atol=1e-3)


BRUTE_NODES = 6
SPRINGY = FREE._replace(
    tendon_stiffness_N=5e3, load_stiffness_N_per_mm=30.0, sheath_length_mm=300.0
)


def compliances(rig, spring_compliance):
    """Half segments at both ends, with free tendon and spring in series."""
    whole = rig.sheath_length_mm / rig.tendon_stiffness_N / BRUTE_NODES
    free = rig.effects.free_tendon
    first = 0.5 * whole + free.proximal_length_mm / rig.tendon_stiffness_N
    last = 0.5 * whole + free.distal_length_mm / rig.tendon_stiffness_N + spring_compliance
    return np.array([first, *[whole] * (BRUTE_NODES - 1), last])


def wandering(rng, scale, samples=80):
    """A motion about zero with reversals of many sizes."""
    knots = scale * rng.uniform(-1.0, 1.0, samples // 4)
    return np.interp(np.linspace(0.0, knots.size - 1.0, samples), np.arange(knots.size), knots)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("drive", "load"),
    [
        ("displacement", "spring"),
        ("displacement", "force"),
        ("displacement", "displacement"),
        ("force", "spring"),
        ("force", "displacement"),
        ("displacement", "push-pull"),
    ],
)
def test_everything_that_varies_at_once_is_that_of_the_relaxed_chain(drive, load, seed):
    """Friction, bend and preload change together with what is given at both ends."""
    rng = np.random.default_rng(seed)
    compliance = 1.0 / 30.0 if load == "spring" else 0.0
    boundary = Boundary(
        FORCE if drive == "force" else DISPLACEMENT,
        FORCE if load in {"force", "push-pull"} else DISPLACEMENT,
        compliance,
    )
    wrap, preload = A + wandering(rng, 0.3 * A), 25.0 + wandering(rng, 4.0)
    at_drive = 25.0 + wandering(rng, 20.0) if drive == "force" else wandering(rng, 1.5)
    at_load = {
        "spring": np.zeros(80),
        "force": 25.0 + wandering(rng, 10.0),
        "displacement": wandering(rng, 0.5),
        "push-pull": wandering(rng, 30.0),
    }[load]
    x_in, x_out, f_in, f_out, phase = follow(
        at_drive,
        load=at_load,
        rig=SPRINGY,
        boundary=boundary,
        n=BRUTE_NODES,
        wrap=wrap,
        preload=preload,
    )
    history = relaxed_chain(
        at_drive,
        at_load,
        wrap,
        preload,
        compliances(SPRINGY, compliance),
        drive_by_force=drive == "force",
        load_by_force=boundary.load == FORCE,
    )
    assert set(phase) == {0, 1, -1}
    assert (f_in.min() < -10.0) == (load == "push-pull")
    spring = (f_out - preload) * compliance
    for answer, reference, tolerance in (
        (f_in, [T[0] for _, T in history], 1e-6),
        (f_out, [T[-1] for _, T in history], 1e-6),
        (x_in, [x[0] for x, _ in history], 1e-7),
        (x_out - spring, [x[-1] for x, _ in history], 1e-7),
    ):
        # The chain goes in smaller steps where one is too large, the reference never does.
        apart = np.abs(answer - reference) > tolerance
        assert np.mean(apart) < 0.05
        np.testing.assert_allclose(answer, reference, atol=1e5 * tolerance)


PUSHED = [("drive", 1.3), ("load", 1.15), ("drive", 1.05), ("load", 0.9), ("drive", 1.2)]


@pytest.mark.parametrize("boundary", [LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT])
def test_fronts_from_both_ends_are_those_of_the_profile(boundary):
    profile, drive, load, exact = Profile(FREE), [], [], []
    for end, factor in PUSHED:
        pull = {
            "drive": profile.pull_drive_with_held_load,
            "load": profile.pull_load_with_held_drive,
        }
        pull[end](25.0 * factor)
        drive.append(profile.x_in)
        load.append(profile.tension[-1] if boundary == LOADED_BY_FORCE else profile.x_out)
        exact.append((profile.x_in, profile.x_out, profile.tension[0], profile.tension[-1]))
    answer = follow(drive, load=load, rig=FREE, boundary=boundary, n=400)
    np.testing.assert_allclose(np.transpose(exact)[:2], answer[:2], atol=1e-4)
    np.testing.assert_allclose(np.transpose(exact)[2:], answer[2:4], atol=0.03)


def test_constant_arrays_are_scalars_to_the_last_bit():
    constant = follow(NESTED, wrap=np.full(NESTED.size, A), preload=np.full(NESTED.size, 25.0))
    for array, scalar in zip(constant, follow(NESTED), strict=True):
        np.testing.assert_array_equal(array, scalar)


def test_friction_that_fades_while_nothing_moves_is_that_of_the_rig():
    """An independent solver with another friction law; the tendon creeps while the drive rests."""
    t = np.arange(301.0)
    motion = Motion(t, np.interp(t, [0, 100, 200, 300], [0, 10, 10, 8]))
    fading = ((0.0, 1.0), (100.0, 1.2), (200.0, 0.7), (300.0, 0.9))
    made = tendon.Rig(
        friction_course=fading, proximal_length_mm=152.0, distal_length_mm=61.0, cells=60
    )
    expected = tendon.simulate(made, motion).columns
    wrap = A * np.interp(t, *np.transpose(fading))
    _, x_out, f_in, f_out, phase = follow(motion.x_in_mm, rig=FREE, wrap=wrap, n=60)
    assert np.ptp(f_in[100:200]) > 10.0
    np.testing.assert_allclose(f_in, expected["f_in_N"], atol=0.05)
    np.testing.assert_allclose(f_out, expected["f_out_N"], atol=0.05)
    np.testing.assert_allclose(x_out, expected["x_out_mm"], atol=0.05)
    assert (phase[110:200] == 1).all()


@pytest.mark.parametrize("n", [1, 2, 30])
def test_a_slack_tendon_carries_nothing_until_it_is_taut_again(n):
    motion = through(5.0, -40.0, 10.0, -5.0, -40.0, -41.0, 20.0)
    exact_in, exact_out, exact_phase = branches(motion, FREE)
    _, _, f_in, f_out, phase = follow(motion, rig=FREE, n=n)
    assert f_in.min() == f_out.min() == 0.0
    np.testing.assert_array_equal(phase == 2, exact_phase == 2)
    loose = phase == 2
    assert not f_in[loose].any()
    assert not f_out[loose].any()
    if n == 30:
        np.testing.assert_allclose(f_out, exact_out, atol=0.02)
        assert np.sqrt(np.mean((f_in - exact_in) ** 2)) < 0.02


def test_one_large_step_is_many_small_ones():
    turns = np.array([14.0, 13.93, 13.96, 13.2, 13.3, -5.0, 13.0])
    fine = follow(through(*turns, samples=1000), rig=FREE)
    for coarse, small in zip(follow(turns, rig=FREE), fine, strict=True):
        np.testing.assert_allclose(coarse, small[999::1000], rtol=1e-7)


@pytest.mark.parametrize("n", [1, 2, 7])
def test_few_nodes_obey_the_capstan_ratio_too(n):
    _, _, f_in, f_out, phase = follow(through(20.0, 0.0), n=n)
    for direction in (1, -1):
        slipping = phase == direction
        assert slipping.any()
        np.testing.assert_allclose(f_in[slipping] / f_out[slipping], UP**direction, rtol=1e-9)
