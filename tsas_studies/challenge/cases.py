"""The cases of the blind benchmark: what is hidden, how large, in which order.

A seed tells everything: `cases(seed)` gives every effect of the catalogue at full size and at
0.4 of it, pairs, triples, cases with nothing hidden, causes that the catalogue does not hold,
causes that are near to it, small faults of sensors, and faults of recording; then all but the last
two under realistic conditions. Whoever builds or tunes a
tool uses the seeds of BUILDING; those of SCORING are for measuring it, once.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from tsas_studies.challenge.conditions import Conditions
from tsas_studies.challenge.faults import FAULTS
from tsas_studies.challenge.near import (
    MIXABLE,
    MIXED,
    MIXED_SIZE,
    NEAR_FULL,
    RESERVED,
    drawn_near,
    drawn_variant,
    stream,
)
from tsas_studies.challenge.recording_faults import RECORDING_FAULTS, drawn_recording
from tsas_studies.challenge.rig.hidden import CATALOGUE

BUILDING = range(1000)
SCORING = range(10_000, 20_000)

SIZES = (1.0, 0.4)
VARIES = 0.2  # a size differs from seed to seed by up to this share
NOTHING = 10
RANDOM_PAIRS = 4
FEW = 2  # cases of a kind in a small part of a set

RANDOM_TRIPLES = 2

Kind = Literal["one", "pair", "triple", "nothing", "unknown", "near", "fault", "recording"]
Drawn = Iterator[tuple[str, Kind, float, tuple["Hidden", ...]]]
# Where the numbers of later kinds of cases begin: one more case leaves the others as they are.
NEAR_FROM, SLOW_FROM, TRIPLES_FROM, FAULTS_FROM, RECORDING_FROM = 1000, 2000, 3000, 4000, 5000


@dataclass(frozen=True)
class Hidden:
    """One hidden cause and its parameters, for an effect with the catalogue's names and units."""

    cause: str
    parameters: Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """One case of the set of a seed.

    Seed, salt and number, its place in the set, together seed what else is drawn. The same case
    under other conditions has the same number, and the same rig but for that.
    """

    name: str  # what it is, for people; sealed like the rest
    kind: Kind  # how many effects of the catalogue are hidden, or that it is something else
    size: float  # factor on the full sizes
    hidden: tuple[Hidden, ...]
    seed: int
    number: int
    conditions: Conditions = "clean"  # what its rig has beside what is hidden
    salt: int = 0  # of the whole set

    @property
    def chance(self) -> int:
        """What seeds its streams of chance: the seed, and with a salt nothing that one can try."""
        return salted(self.seed, self.salt)


def salted(seed: int, salt: int) -> int:
    """Return a seed with the salt in front of its 64 bits; without one, the seed."""
    return seed + (salt << 64)


# Full sizes, from which a case draws one variant. Chosen with benchmarks/challenge_sizes.py: each
# changes f_in or f_out by 0.4 to 1 N RMS, or x_out by 0.04 to 0.1 mm, beyond what a refit of
# friction, load stiffness, tendon stiffness, preload and the zero of x_in absorbs; the noise is
# 0.1 N and 0.01 mm. Sheath compression is a softer tendon to such a refit: its size is beyond
# what the data sheet allows, also at 0.4 (EA less by 50 % and 29 %; nominal values are off by up
# to 10 %).
FULL: Mapping[str, tuple[Mapping[str, float], ...]] = {
    "backlash": ({"play_mm": 0.02},),
    "drive_friction": ({"friction_N": 1.5},),
    "drive_ripple": ({"sine_mm": 0.05, "cosine_mm": 0.0, "period_mm": 0.7095},),
    "drive_compliance": ({"compliance_mm_per_N": 0.003},),
    "proximal_spring": ({"stiffness_N_per_mm": 0.12},),
    "free_tendon": ({"proximal_length_mm": 200.0, "distal_length_mm": 80.0},),
    "sheath_compression": ({"compliance_ratio": 1.0},),
    "direction_dependent_friction": ({"asymmetry": 0.1},),
    "stribeck_friction": ({"excess": 0.15, "velocity_mm_per_s": 5.0},),
    "viscous_friction": ({"coefficient_N_s_per_mm": 0.12},),
    "load_dependent_friction": ({"exponent": 0.15},),
    "presliding": ({"length_mm": 0.025},),
    "bend_drift": ({"rate_rad_per_s": 0.02, "settling_per_s": 0.0},
                   {"rate_rad_per_s": 0.08, "settling_per_s": 0.2}),
    "friction_drift": ({"rate_per_s": 0.008, "settling_per_s": 0.0},
                       {"rate_per_s": 0.03, "settling_per_s": 0.2},
                       {"session_rate_per_s": 7e-5}),
    "preload_loss": ({"rate_N_per_s": 0.12, "settling_per_s": 0.0},
                     {"rate_N_per_s": 0.5, "settling_per_s": 0.2}),
    "load_spring_nonlinearity": ({"quadratic_per_mm": 0.012}, {"cubic_per_mm2": 0.0004}),
    "load_friction": ({"after_sensor_N": 0.7}, {"before_sensor_N": 2.0}),
    "load_inertia": ({"mass_kg": 20.0},),
    "force_sensor_gain": ({"f_out_gain": 1.04},),
    "force_sensor_offset": ({"f_in_offset_N": 1.4}, {"f_out_offset_N": 1.4}),
    "force_sensor_drift": (
        {"f_in_rate_N_per_s": 0.1, "settling_per_s": 0.0},
        {"f_out_rate_N_per_s": 0.1, "settling_per_s": 0.0},
        {"f_in_rate_N_per_s": 0.3, "settling_per_s": 0.2},
        {"f_out_rate_N_per_s": 0.3, "settling_per_s": 0.2},
        {"f_in_session_rate_N_per_s": 1e-3},
        {"f_out_session_rate_N_per_s": 1e-3},
    ),
    "position_sensor_gain": ({"x_out_gain": 1.015},),
    "channel_delay": ({"f_in_delay_s": 0.014}, {"f_out_delay_s": 0.04}, {"x_out_delay_s": 0.007}),
}  # fmt: skip

NEUTRAL = {"f_out_gain": 1.0, "x_out_gain": 1.0}  # zero for all others
UNSCALED = frozenset({"period_mm", "velocity_mm_per_s", "settling_per_s"})
ONE_SIGN = frozenset({
    "backlash", "drive_friction", "drive_compliance", "proximal_spring", "free_tendon",
    "sheath_compression", "stribeck_friction", "viscous_friction", "presliding", "preload_loss",
    "load_friction", "load_inertia",
})  # fmt: skip

PAIRS = (
    ("backlash", "force_sensor_offset"),
    ("drive_friction", "free_tendon"),
    ("drive_ripple", "friction_drift"),
    ("proximal_spring", "load_friction"),
    ("direction_dependent_friction", "preload_loss"),
    ("stribeck_friction", "position_sensor_gain"),
    ("viscous_friction", "load_spring_nonlinearity"),
    ("load_dependent_friction", "channel_delay"),
    ("presliding", "force_sensor_drift"),
    ("bend_drift", "drive_compliance"),
    ("load_inertia", "backlash"),
    ("force_sensor_gain", "drive_friction"),
)


TRIPLES = (
    ("drive_friction", "stribeck_friction", "force_sensor_offset"),
    ("backlash", "viscous_friction", "load_friction"),
    ("direction_dependent_friction", "force_sensor_gain", "preload_loss"),
    ("drive_compliance", "load_spring_nonlinearity", "channel_delay"),
    ("presliding", "friction_drift", "position_sensor_gain"),
    ("load_dependent_friction", "proximal_spring", "force_sensor_drift"),
)


def cases(seed: int, salt: int = 0) -> tuple[Case, ...]:
    """Return all cases of a seed and a salt, about 430.

    The clean ones, nulls in slow noise, and the clean ones again under realistic conditions, but
    for faults of recording and small faults of sensors, which are of the size of those conditions.
    """
    chance = salted(seed, salt)
    listed = (
        *enumerate(_all(np.random.default_rng(chance))),
        *enumerate(_near(chance), NEAR_FROM),
        *enumerate(_triples(chance), TRIPLES_FROM),
        *enumerate(_faults(chance), FAULTS_FROM),
        *enumerate(_of_recording(chance), RECORDING_FROM),
    )
    clean = [
        Case(name, kind, size, hidden, seed, number, salt=salt)
        for number, (name, kind, size, hidden) in listed
        if seed in SCORING or not RESERVED & {cause.cause for cause in hidden}
    ]
    slow = [
        Case(name, "nothing", 0.0, (), seed, SLOW_FROM + k, "slow", salt)
        for k, name in enumerate(f"nothing {n} in slow noise" for n in range(1, NOTHING + 1))
    ]
    realistic = [
        replace(case, name=f"{case.name}, realistic", conditions="realistic")
        for case in clean
        if case.kind not in ("fault", "recording")
    ]
    return (*clean, *slow, *realistic)


def part(of: Iterable[Case]) -> tuple[Case, ...]:
    """Return a small part of the cases: each effect once at full size, a few of what is none."""
    listed = [case for case in of if case.conditions == "clean"]
    kept = [case for case in listed if case.kind == "one" and case.size == max(SIZES)]
    for kind in ("nothing", "unknown", "near", "fault", "recording"):
        kept += [case for case in listed if case.kind == kind][:FEW]
    return tuple(kept)


def _all(rng: np.random.Generator) -> Drawn:
    for effect in FULL:
        for size in SIZES:
            yield f"{effect}, size {size:g}", "one", size, (drawn(effect, size, rng),)
    names = list(FULL)
    random_pairs = [tuple(rng.choice(names, 2, replace=False)) for _ in range(RANDOM_PAIRS)]
    for pair in (*PAIRS, *random_pairs):
        yield " and ".join(pair), "pair", 1.0, tuple(drawn(str(e), 1.0, rng) for e in pair)
    for number in range(NOTHING):
        yield f"nothing {number + 1}", "nothing", 0.0, ()
    for unknown in _unknowns(rng):
        yield unknown.cause, "unknown", 1.0, (unknown,)


def _triples(seed: int) -> Drawn:
    rng = stream(seed, "triples")
    chosen = [tuple(rng.choice(list(FULL), 3, replace=False)) for _ in range(RANDOM_TRIPLES)]
    for triple in (*TRIPLES, *chosen):
        yield " and ".join(triple), "triple", 1.0, tuple(drawn(str(e), 1.0, rng) for e in triple)


def _near(seed: int) -> Drawn:
    """Yield what is near to the catalogue, or what the catalogue has got since, at each size.

    And several small ones of what is near at once.
    """
    for size in SIZES:
        chosen = stream(seed, f"{MIXED} {size:g}").choice(MIXABLE, 3, replace=False)
        small = MIXED_SIZE * size
        parts = tuple(Hidden(str(c), drawn_near(str(c), small, seed)) for c in sorted(chosen))
        yield f"{MIXED}, size {size:g}", "near", size, parts
    for cause in NEAR_FULL:
        kind: Kind = "one" if cause in CATALOGUE else "near"
        for size in SIZES:
            hidden = Hidden(cause, drawn_near(cause, size, seed))
            yield f"{cause}, size {size:g}", kind, size, (hidden,)


def _faults(seed: int) -> Drawn:
    for fault in FAULTS:
        for size in SIZES:
            drawn = drawn_variant(FAULTS[fault], size, stream(seed, f"small {fault} {size:g}"))
            yield f"small {fault}, size {size:g}", "fault", size, (Hidden(fault, drawn),)


def _of_recording(seed: int) -> Drawn:
    """Yield a sound rig with one fault of recording, at each size."""
    for fault, known in RECORDING_FAULTS.items():
        for size in known.sizes:
            hidden = Hidden(fault, drawn_recording(fault, size, seed))
            yield f"{fault}, {size:g} x the noise", "recording", size, (hidden,)


def drawn(effect: str, size: float, rng: np.random.Generator) -> Hidden:
    """Return an effect at a size, with variant, sign and a little of the size left to chance."""
    variants = FULL[effect]
    full = dict(variants[rng.integers(len(variants))])
    factor = size * rng.uniform(1.0 - VARIES, 1.0 + VARIES)
    if effect not in ONE_SIGN:
        factor *= rng.choice((-1.0, 1.0))
    if effect == "drive_ripple":
        phase = rng.uniform(0.0, 2.0 * np.pi)
        full |= {"cosine_mm": full["sine_mm"] * np.cos(phase)}
        full |= {"sine_mm": full["sine_mm"] * np.sin(phase)}
    for name in full.keys() - UNSCALED:
        neutral = NEUTRAL.get(name, 0.0)
        full[name] = float(neutral + factor * (full[name] - neutral))
    return Hidden(effect, full)


def _unknowns(rng: np.random.Generator) -> Iterator[Hidden]:
    """Yield each cause that the catalogue does not hold, at sizes chosen like the full ones."""

    def about(value: float) -> float:
        return float(value * rng.uniform(1.0 - VARIES, 1.0 + VARIES))

    yield Hidden(
        "rough_spot", {"friction_N": about(3.0), "position_mm": about(11.0), "width_mm": 1.0}
    )
    phase = float(rng.uniform(0.0, 2.0 * np.pi))
    yield Hidden("hum", {"amplitude_N": about(0.9), "frequency_Hz": about(3.0), "phase_rad": phase})
    warm = 1.0 + about(0.1)
    yield Hidden(
        "warm_friction",
        {"course": ((0.0, 1.0), (about(5.0), warm), (about(9.0), warm), (about(16.0), 1.0))},
    )
    # What the jump takes from the tension stays above down_N, so that it does not chatter.
    up, down = float(rng.uniform(50.0, 58.0)), float(rng.uniform(19.0, 22.0))
    yield Hidden("loose_clamp", {"step_mm": about(0.08), "up_N": up, "down_N": down})
    moments = np.sort(rng.uniform(2.0, 18.0, 3))
    lost = about(0.12) * np.cumsum(rng.choice((-1.0, 1.0), 3, p=(0.8, 0.2)))
    yield Hidden(
        "missed_counts",
        {"jumps": tuple((float(t), float(by)) for t, by in zip(moments, lost, strict=True))},
    )
    yield Hidden("tendon_creep", {"compliance_mm_per_N": about(0.008), "time_s": about(3.0)})
    yield Hidden("end_stop", {"position_mm": about(16.0), "stiffness_N_per_mm": about(1.0)})
