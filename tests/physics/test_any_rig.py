"""What holds for every rig and every motion, tried on wide random ones."""

import math

import numpy as np
import pytest

from tests.physics.references import Profile, branches, course_of, slip_chain, static_model, wrap_of
from tsas_cli.effects import Effects, FreeTendon
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.physics.rig import Rig

SEEDS = range(1000)
LARGE = pytest.mark.large


def blocks(seeds, size):
    """Return the seeds in blocks, of which the first is tried each time."""
    starts = range(seeds.start, seeds.stop, size)
    return [pytest.param(seeds[k : k + size], marks=LARGE if k else (), id=str(k)) for k in starts]


def any_rig(rng):
    """Every parameter over orders of magnitude; the wrap angle times friction up to about 6."""

    def between(low, high):
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    return Rig(
        friction_coefficient=between(0.01, 0.5),
        tendon_stiffness_N=between(1e3, 1e6),
        load_stiffness_N_per_mm=between(1e-2, 1e3),
        sheath_length_mm=between(50.0, 5000.0),
        total_bend_rad=between(0.1, 12.0),
        preload_N=between(0.5, 200.0),
        effects=Effects(
            free_tendon=FreeTendon(rng.choice([0.0, between(1.0, 500.0)]), between(1.0, 500.0))
        ),
    )


def way_to_slack(rig):
    profile = Profile(rig, 2001)
    profile.pull_drive_to(0.0)
    return -profile.x_in


def any_motion(rng, rig, samples=300):
    """Reversals of all sizes, from a hundredth of the dead band to far into full slip and slack."""
    turns = way_to_slack(rig) * rng.normal(0.0, 2.0, 15) * 10.0 ** rng.uniform(-3.0, 0.3, 15)
    turns = np.cumsum(np.concatenate(([0.0], turns)))
    return np.interp(np.linspace(0.0, 15.0, samples), np.arange(16), turns)


def chain(rig, drive, load, values, n=20):
    kinds = {"spring": SPRING, "force": FORCE, "displacement": DISPLACEMENT}
    return slip_chain(
        course_of(drive, rig, load=values), rig, Boundary(DISPLACEMENT, kinds[load]), n
    )


def every_answer(rig, motion, rng):
    """The closed form, the lumped model, and the chain with each load."""
    f_in, f_out, phase = branches(motion, rig)
    yield "closed form", f_in, f_out, phase
    yield "lumped", *static_model(motion, rig)
    knots = rng.normal(1.0, 0.2, 6)
    factor = np.interp(np.linspace(0, 5, motion.size), np.arange(6), knots)
    loads = {
        "spring": np.zeros_like(motion),
        "force": factor * f_out,
        "displacement": factor * (f_out - rig.preload_N) / rig.load_stiffness_N_per_mm,
    }
    for load, values in loads.items():
        yield load, *chain(rig, motion, load, values)[2:]


@pytest.mark.parametrize("samples", [16, 300])
@pytest.mark.parametrize("seeds", blocks(SEEDS, 250))
def test_the_ends_never_leave_the_capstan_cone(seeds, samples):
    for seed in seeds:
        rng = np.random.default_rng(seed)
        rig = any_rig(rng)
        motion = any_motion(rng, rig, samples)
        for name, f_in, f_out, phase in every_answer(rig, motion, rng):
            where = f"seed {seed}, {name}, {rig}"
            assert np.isfinite([f_in, f_out]).all(), where
            assert UNCONVERGED not in phase, where
            if name != "force":
                assert min(f_in.min(), f_out.min()) >= 0.0, where
                forwards = np.diff(f_in) * np.diff(motion) >= -1e-9 * f_in.max()
                assert forwards.all() or name == "displacement", where
            assert (np.sign(f_in) * np.sign(f_out) >= 0.0).all(), where
            # A straight dead band from anywhere but a corner of the cycle may end a bit too late.
            taut = (f_in != 0.0) & (phase != 2) & (name != "lumped")
            ratio = np.abs(np.log(f_in[taut] / f_out[taut]))
            assert ratio.max(initial=0.0) <= wrap_of(rig) * (1 + 1e-7) + 1e-7, where
            slipping = np.isin(phase, (1, -1)) & (np.abs(f_in) > 1e-6 * rig.preload_N)
            direction = np.sign(f_in) * phase
            np.testing.assert_allclose(
                np.log(f_in[slipping] / f_out[slipping]),
                direction[slipping] * wrap_of(rig),
                atol=1e-6 + 1e-6 * wrap_of(rig),
                err_msg=where,
            )


@pytest.mark.parametrize("seeds", blocks(SEEDS[:200], 50))
def test_the_chain_is_the_closed_form(seeds):
    """Its error is a part of the tension of the order of what one node holds back."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        rig = any_rig(rng)
        motion = any_motion(rng, rig)
        exact, _, exact_phase = branches(motion, rig)
        _, _, f_in, _, phase = chain(rig, motion, "spring", np.zeros_like(motion), n=60)
        error = np.abs(f_in - exact) / np.maximum.accumulate(exact)
        assert error.max() < 2.0 * wrap_of(rig) / 60.0, seed
        assert np.sqrt(np.mean(error**2)) < 0.2 * wrap_of(rig) / 60.0, seed
        assert np.mean(phase != exact_phase) < 0.02, seed


def there_and_back(rng, far, samples=2000):
    """Go to a far point, wander about, and come back to it; with the slice of the round trip."""
    turns = np.array([0.0, 1.0, 1.0, 1.0, *rng.uniform(-0.5, 1.0, 6), 1.0])
    x = far * np.interp(np.linspace(0.0, 10.0, samples + 1), np.arange(11), turns)
    return x, slice(3 * samples // 10, None)


@pytest.mark.parametrize("load", ["spring", "force", "displacement"])
def test_friction_never_creates_energy(load):
    """After a round trip that ends in full slip the tendon is as before: the ends' work is lost."""
    closed = 0
    for seed in SEEDS[:100]:
        rng = np.random.default_rng(seed)
        rig = any_rig(rng)
        x, trip = there_and_back(rng, way_to_slack(rig) * rng.uniform(0.2, 3.0))
        level = branches(x, rig)[1][trip][0]
        wander, _ = there_and_back(rng, 1.0)
        values = {
            "spring": np.zeros_like(x),
            "force": level * (0.2 + 0.8 * wander),
            "displacement": (level - rig.preload_N) / rig.load_stiffness_N_per_mm * wander,
        }[load]
        x_in, x_out, f_in, f_out, phase = (c[trip] for c in chain(rig, x, load, values))
        if load == "spring":
            x_out = np.zeros_like(x_in)  # the spring gives back what it stored
        work = np.trapezoid(f_in, x_in) - np.trapezoid(f_out, x_out)
        scale = np.sum(np.abs(np.diff(x_in))) * f_in.max()
        if phase[0] == phase[-1] == 1:
            closed += 1
            np.testing.assert_allclose([f_in[-1], f_out[-1]], [f_in[0], f_out[0]], rtol=1e-6)
            assert work > 1e-6 * scale, seed
    assert closed > 30
