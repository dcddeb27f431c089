"""What acts on the load beside its spring: a damper, inner friction, relaxation, a pulley, a clamp.

All of it is a force on the load and is felt by the force sensor f_out.
"""

from dataclasses import dataclass
from math import exp, inf
from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl, dahl_slope


@dataclass(frozen=True)
class Restraint:
    """What holds the load back; all zeros are none of it.

    Attributes
    ----------
    damping_N_s_per_mm
        A damper to ground.
    hysteresis_N, hysteresis_mm
        An elastoplastic element beside the spring: its largest force, and the displacement over
        which it turns. It follows Dahl's law, with the lost work of a straight one that gains
        hysteresis_N per hysteresis_mm.
    relaxing_share, relaxing_s
        A spring and damper in series beside the spring (standard linear solid): so much of the
        spring's stiffness, which relaxes in this time.
    ripple_sine_mm, ripple_cosine_mm, ripple_period_mm
        An eccentric pulley: the spring is stretched by x + sine · sin(2πx/period) + cosine ·
        (cos(2πx/period) − 1).
    clamp_play_mm, clamp_up_N, clamp_down_N
        The spring's anchor sits in a slot of this length: it slides where the spring's force
        exceeds clamp_up_N, and back where it falls below clamp_down_N.
    """

    damping_N_s_per_mm: float = 0.0
    hysteresis_N: float = 0.0
    hysteresis_mm: float = 1.0
    relaxing_share: float = 0.0
    relaxing_s: float = 1.0
    ripple_sine_mm: float = 0.0
    ripple_cosine_mm: float = 0.0
    ripple_period_mm: float = 10.0
    clamp_play_mm: float = 0.0
    clamp_up_N: float = inf
    clamp_down_N: float = -inf


class RestraintLaw(NamedTuple):
    """`Restraint` in the solver; up and down are displacements of the spring [mm]."""

    stiffness: float
    damping: float
    hysteresis: float
    travel: float
    relaxing: float
    time: float
    sine: float
    cosine: float
    period: float
    play: float
    up: float
    down: float


class RestraintState(NamedTuple):
    """The inner friction, the stretch of the relaxing spring [mm], where the anchor is [mm]."""

    bristle: float
    relaxing: float
    anchor: float


def restraint(of: Restraint, stiffness_N_per_mm: float, preload_N: float) -> RestraintLaw:
    """Return the restraint of a load spring for the solver."""
    return RestraintLaw(
        stiffness_N_per_mm,
        of.damping_N_s_per_mm,
        of.hysteresis_N,
        of.hysteresis_mm,
        of.relaxing_share * stiffness_N_per_mm,
        of.relaxing_s,
        of.ripple_sine_mm,
        of.ripple_cosine_mm,
        of.ripple_period_mm,
        of.clamp_play_mm,
        (of.clamp_up_N - preload_N) / stiffness_N_per_mm,
        (of.clamp_down_N - preload_N) / stiffness_N_per_mm,
    )


@compiled
def restrained(
    law: RestraintLaw, before: RestraintState, y: float, dy: float, h: float
) -> tuple[float, float]:
    """Return the force [N] at y after a displacement dy within h seconds, and its slope [N/mm]."""
    force, slope = law.damping * dy / h, law.damping / h
    force += law.hysteresis * dahl(dy, before.bristle, law.travel, 0.0, 1.0)
    slope += law.hysteresis * dahl_slope(dy, before.bristle, law.travel, 0.0, 1.0)
    kept = _kept(h, law.time)
    force += law.relaxing * (before.relaxing * exp(-h / law.time) + dy * kept)
    slope += law.relaxing * kept
    turn = 2.0 * np.pi / law.period
    wave = law.sine * np.sin(turn * y) + law.cosine * (np.cos(turn * y) - 1.0)
    force += law.stiffness * wave
    slope += law.stiffness * turn * (law.sine * np.cos(turn * y) - law.cosine * np.sin(turn * y))
    anchor = _anchor(law, before.anchor, y)
    force -= law.stiffness * anchor
    if anchor != before.anchor and 0.0 < anchor < law.play:
        slope -= law.stiffness
    return force, slope


@compiled
def held(
    law: RestraintLaw, before: RestraintState, y: float, dy: float, h: float
) -> RestraintState:
    """Return the state after the load has gone to y by dy within h seconds."""
    return RestraintState(
        dahl(dy, before.bristle, law.travel, 0.0, 1.0),
        before.relaxing * exp(-h / law.time) + dy * _kept(h, law.time),
        _anchor(law, before.anchor, y),
    )


@compiled
def _kept(h: float, time: float) -> float:
    """Return what share of an even stretch within h seconds has not relaxed by their end."""
    return float(-np.expm1(-h / time) * time / h)


@compiled
def _anchor(law: RestraintLaw, before: float, y: float) -> float:
    """Return where the anchor is in its slot [mm] once the load is at y."""
    return min(max(before, min(y - law.up, law.play)), max(y - law.down, 0.0))
