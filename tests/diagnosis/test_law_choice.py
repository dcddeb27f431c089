"""Which law of unnamed origin is taken, on what ranges, at what cost, and how sure its curves are.

The errors of each set on held-out data are given: two channels of three times the noise.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.diagnosis import law as module
from tsas_cli.diagnosis import law_bench, law_words
from tsas_cli.diagnosis.refitted import HeldOutFit
from tsas_cli.effects import LAWS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.records.base import TWO_SIDED

F, X = "f_in_N", "x_out_mm"
DRIVE, LOAD, TENDON = ("drive_law",), ("load_law",), ("tendon_law",)
BOTH, WITH_TENDON, ALL = DRIVE + LOAD, TENDON + LOAD, DRIVE + TENDON + LOAD
BLOCKS = 40
FOLDS = SimpleNamespace(run=np.zeros(BLOCKS, int), block=np.arange(BLOCKS), blocks=BLOCKS)


@dataclass(frozen=True)
class Trial:
    """A fit of some effects with the squares that it leaves."""

    effects: frozenset[str]
    mean_square: float
    on_mesh: bool = False
    solution: SimpleNamespace = field(
        default_factory=lambda: SimpleNamespace(
            jacobian=np.eye(BLOCKS)[:, :2], at_bound=np.zeros(2, bool), residual=np.ones(BLOCKS)
        )
    )


@dataclass(frozen=True)
class World:
    """A bench: the RMS of both channels by set of laws; 3 and 3 with any other set."""

    rms: Mapping[tuple[str, ...], tuple[float, float]]
    channels: tuple[str, ...] = (F, X)
    closed: tuple[object, ...] = ()
    priors: Mapping[str, float] = field(default_factory=lambda: {"a": 1.0})
    tried: list[tuple[str, ...]] = field(default_factory=list)
    gains: float = 0.0  # on held-out data, by a lower cost

    def on_mesh(self, names):
        return False

    def of(self, effects):
        return next((v for k, v in self.rms.items() if frozenset(k) == effects), (3.0, 3.0))

    def fit(self, names, **_):
        self.tried.append(tuple(names))
        force, length = self.of(frozenset(names))
        return Trial(frozenset(names), 0.5 * (force**2 + length**2) / 9.0)


def held_out(bench, trial, folds, *, scatter):
    """Return the errors of a set in blocks of which each is a little different."""
    force, length = bench.of(trial.effects)
    lower = (1.0 - bench.priors["a"]) * bench.gains
    rmse = {n: r - lower for n, r in ((F, force), (X, length)) if n in bench.channels}
    squares = sum(rms**2 for rms in rmse.values()) / 9.0 * np.linspace(0.9, 1.1, BLOCKS)
    return HeldOutFit(rmse, {}, squares, {(0, name): rms for name, rms in rmse.items()})


@pytest.fixture
def described(monkeypatch):
    """Return what describes a world, in which the noise of both channels is 1."""
    for attribute, value in {
        "ranges_of": lambda runs: {name: {} for (name,) in (DRIVE, LOAD, TENDON)},
        "in_channel_units": lambda bench, *_: bench,
        "priors_of": lambda bench, *_: bench.priors,
        "noise_floor": lambda *_: 1.0,
        "scatter_is_no_effect": lambda *_: True,
        "refitted": held_out,
        "_without_slopes": lambda trial: trial,
        "_estimates": lambda *_: [],
    }.items():
        monkeypatch.setattr(module, attribute, value)
    return lambda world: module.describe(world, Trial(frozenset(), 1.0), FOLDS)


ONE_OF_TWO = {DRIVE: (1.0, 3.0), LOAD: (3.0, 1.0)}


@pytest.mark.parametrize(
    ("rms", "taken", "rivals"),
    [
        ({}, None, ()),
        ({DRIVE: (1.0, 3.0)}, DRIVE, ()),
        ({DRIVE: (1.0, 3.08)}, DRIVE, ()),
        ({DRIVE: (1.0, 3.1)}, None, ()),  # a channel that is worse by more than a thirtieth
        ({DRIVE: (2.45, 3.0)}, None, ()),  # a third of what exceeds the noise, of 8 of 9 parts, is
        ({DRIVE: (1.88, 3.0)}, DRIVE, ()),  # 0.296 of the squares of both channels
        ({DRIVE: (1.95, 3.0)}, None, ()),
        ({DRIVE: (1.5, 3.0), TENDON: (1.5, 3.0)}, DRIVE, ("tendon_law",)),
        ({DRIVE: (1.5, 3.0), TENDON: (1.4, 3.0)}, TENDON, ("drive_law",)),
        ({DRIVE: (1.5, 3.0), TENDON: (1.0, 2.8)}, TENDON, ()),
        (ONE_OF_TWO | {BOTH: (1.0, 1.0)}, BOTH, ()),
        (ONE_OF_TWO | {BOTH: (1.3, 1.3), WITH_TENDON: (1.3, 1.31)}, BOTH, ("tendon_law+load_law",)),
        (ONE_OF_TWO | {BOTH: (1.0, 2.9)}, DRIVE, ("load_law",)),  # two that do no better than one
        ({DRIVE: (1.2, 2.0), BOTH: (1.1, 1.95), ALL: (1.0, 1.5)}, ALL, ()),
    ],
)
def test_the_fewest_laws_are_taken_that_take_most(described, rms, taken, rivals):
    found = described(World(rms))
    assert (None if found is None else found.names) == taken
    if found is not None:
        assert found.rivals == rivals
        assert found.before.rmse == {F: 3.0, X: 3.0}
        assert found.after.rmse == dict(zip((F, X), rms[taken], strict=True))


@pytest.mark.parametrize(("rms", "count"), [((1.09, 1.09), 1), ((1.09, 1.11), 6)])
def test_at_the_noise_no_further_set_is_tried(described, rms, count):
    world = World({DRIVE: rms})
    assert described(world).names == DRIVE
    assert len([names for names in dict.fromkeys(world.tried) if names]) == count


def test_a_law_whose_channel_was_not_recorded_is_not_tried(described):
    world = World({DRIVE: (1.0, 1.0)}, channels=(X,))
    assert described(world) is None
    assert [names for names in world.tried if names] == [LOAD]


@pytest.mark.parametrize(("gains", "cost"), [(0.1, 0.3**2), (0.0, 1.0), (-0.1, 1.0)])
def test_the_cost_of_a_chosen_law_is_lowered_twice_while_that_predicts_better(
    described, gains, cost
):
    found = described(World({DRIVE: (1.5, 3.0)}, gains=gains))
    assert found.bench.priors["a"] == pytest.approx(cost)
    assert found.after.rmse[F] == pytest.approx(1.5 - max(gains, 0.0) * (1.0 - cost))


def run_of(time_s, drive, **channels):
    return SimpleNamespace(time_s=time_s, drive=SimpleNamespace(values=drive), channel=channels.get)


def test_a_law_acts_over_the_ranges_of_all_runs():
    """Its widest element is a quarter of the longest stroke, in the sheath an eighth."""
    t = np.linspace(0.0, 1.0, 101)
    slow, fast = 8.0 * t, 2.0 + 40.0 * t
    runs = [
        run_of(t, slow, x_in_mm=slow, x_out_mm=np.where(t > 0.5, np.nan, 6.0 * t)),
        run_of(t, fast, x_in_mm=fast),
    ]
    found = law_bench.ranges_of(runs)
    speeds = {"slow_mm_per_s": 8.0, "fast_mm_per_s": 40.0}
    ends = {"low_mm": 0.0, "high_mm": 42.0}
    for law, widest in (("drive_law", 10.0), ("tendon_law", 5.0)):
        expected = {"travel_mm": widest} | ends | speeds
        assert found[law] == pytest.approx({f"{law}.{n}": v for n, v in expected.items()})
    expected = {"travel_mm": 0.75, "low_mm": 0.0, "high_mm": 3.0}
    assert found["load_law"] == pytest.approx({f"load_law.{n}": v for n, v in expected.items()})
    assert "load_law" not in law_bench.ranges_of(runs[1:])


def test_speeds_are_quantiles_of_the_motion_without_its_rests():
    """Half at rest, half at 1 to 100 mm/s: of these the twentieth and the last but it."""
    moving = np.arange(1.0, 101.0)
    speed = np.concatenate((np.zeros(102), moving))
    t = np.arange(2.0 * speed.size)
    drive = np.concatenate(([0.0], np.cumsum(np.repeat(speed, 2))))[:-1]
    slow, fast = law_bench.speeds_of([run_of(t, -drive)])
    assert (slow, fast) == pytest.approx((5.95, 95.05), abs=0.6)
    even = law_bench.speeds_of([run_of(t, 3.0 * t)])
    assert even == pytest.approx((3.0, 3.3))


NOTHING = {law.name: {p.name: p.neutral for p in law.parameters} for law in LAWS}
A, B = "load_law.lost_1_mm", "load_law.curve_2_mm"
FREE = [f"load_law.{name}" for name in NOTHING["load_law"]][3:]
UNKNOWNS = [B, F, A, *(name for name in FREE if name not in (A, B))]
COVARIANCE = np.zeros((len(UNKNOWNS), len(UNKNOWNS)))
COVARIANCE[:3, :3] = [[9.0, 0.0, 2.0], [0.0, 4.0, 0.0], [2.0, 0.0, 1.0]]


def law_of(**values):
    given = {"travel_mm": 2.0, "low_mm": -1.0, "high_mm": 3.0}
    found = NOTHING["load_law"] | given | values
    runs = [SimpleNamespace(predict=lambda rig, k=k: {F: np.array([k, 5.0 + k])}) for k in (-1, 3)]
    return SimpleNamespace(
        names=LOAD,
        rivals=("drive_law",),
        estimates=[
            Estimate(f"load_law.{n}", v, "mm", "given" if n in given else "fitted")
            for n, v in found.items()
        ],
        trial=SimpleNamespace(unknowns=[SimpleNamespace(name=n) for n in UNKNOWNS]),
        covariance=COVARIANCE,
        bench=SimpleNamespace(errors_for=lambda _: runs, rig=lambda *_: GROUP_A),
        before=SimpleNamespace(rmse={F: 3.0, X: 0.5}),
        after=SimpleNamespace(rmse={F: 2.0, X: 0.1}),
    )


def test_the_curves_of_a_law_have_the_margin_of_its_parameters():
    """Of full slip the lost motion changes by twice its weight; heights are about their mean."""
    (found,) = law_words.records_of(law_of(lost_1_mm=0.2, curve_2_mm=0.05))
    sizes = {name: QUANTITIES[name].size for name in (A, B)}
    assert found.after_reversal[-1] == pytest.approx(0.4)
    assert found.after_reversal_margin[0] == 0.0
    assert found.after_reversal_margin[-1] == pytest.approx(TWO_SIDED * 2.0 * sizes[A] * 1.0)
    assert found.along_stroke == pytest.approx([-0.01, 0.04, -0.01, -0.01, -0.01])
    shares = np.array([0.2, 0.8, 0.2, 0.2, 0.2])
    assert found.along_stroke_margin == pytest.approx(TWO_SIDED * sizes[B] * 3.0 * shares)
    assert (found.travel_mm[0], found.travel_mm[-1]) == pytest.approx((0.0, 4.0))
    assert found.place_mm == pytest.approx([-1.0, 0.0, 1.0, 2.0, 3.0])
    assert (found.rmse_before, found.rmse_after, found.unit) == (0.5, 0.1, "mm")
    assert (found.law, found.rivals, found.what) == ("load_law", ("drive_law",), "x_out [mm]")
    assert set(found.parameters) == set(NOTHING["load_law"])
    assert law_words.records_of(law_of()) == ()


def test_a_margin_holds_what_parameters_do_together():
    """Of a + 2 b with variances 1 and 9 and covariance 2: 1 + 36 + 8."""
    sizes = {name: QUANTITIES[name].size for name in (A, B)}

    def curve(value):
        return np.array([value["lost_1_mm"] / sizes[A] + 2.0 * value["curve_2_mm"] / sizes[B]])

    margin = law_words._margin(law_of(), "load_law", curve)
    assert margin == pytest.approx([TWO_SIDED * np.sqrt(45.0)])


def test_the_tensions_of_a_law_are_those_of_all_runs_that_pull():
    assert law_words.tensions_of(law_of()) == (0.0, 8.0)


def test_friction_along_the_sheath_is_said_with_the_larger_part():
    curve = {f"curve_{k}": 0.1 * (k - 1) for k in range(2, 6)}
    said = law_words.sentence_of("tendon_law", NOTHING["tendon_law"] | curve, (5.0, 25.0))
    assert said == "In the sheath friction changes from 0 to 40 % along the stroke."
    small = law_words.sentence_of(
        "tendon_law", NOTHING["tendon_law"] | {"curve_3": 0.04, "start_1": 0.85}, (5.0, 25.0)
    )
    assert small.startswith("In the sheath friction differs by 85 % after each reversal, over ")
    assert "along" not in small
