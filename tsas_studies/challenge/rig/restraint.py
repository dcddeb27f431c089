"""What acts on the load beside its spring: a damper, inner friction, relaxation, a pulley, a clamp.

All of it is a force on the load and is felt by the force sensor f_out.
"""

from math import exp, inf
from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl, dahl_slope
from tsas_studies.challenge.rig.eccentric import eccentric


class Restraint(NamedTuple):
    """What holds the load back; all zeros are none of it."""

    damping_N_s_per_mm: float = 0.0  # of a damper to ground
    # An elastoplastic element beside the spring: its largest force, and the displacement over which
    # it turns. It follows Dahl's law, with the lost work of a straight one that gains hysteresis_N
    # per hysteresis_mm.
    hysteresis_N: float = 0.0
    hysteresis_mm: float = 1.0
    # A spring and damper in series beside the spring (standard linear solid): so much of the
    # spring's stiffness, which relaxes in this time.
    relaxing_share: float = 0.0
    relaxing_s: float = 1.0
    # An eccentric pulley: the spring is stretched by x + sine · sin(2πx/period) + cosine ·
    # (cos(2πx/period) − 1), and by a second harmonic, shares of the first.
    ripple_sine_mm: float = 0.0
    ripple_cosine_mm: float = 0.0
    ripple_period_mm: float = 10.0
    ripple_second_sine: float = 0.0
    ripple_second_cosine: float = 0.0
    # The spring's anchor sits in a slot of this length: it slides where the spring's force exceeds
    # clamp_up_N, and back where it falls below clamp_down_N.
    clamp_play_mm: float = 0.0
    clamp_up_N: float = inf
    clamp_down_N: float = -inf


class Spring(NamedTuple):
    """The spring of the load."""

    stiffness_N_per_mm: float
    preload_N: float


class RestraintState(NamedTuple):
    """The inner friction, the stretch of the relaxing spring [mm], where the anchor is [mm]."""

    bristle: float
    relaxing: float
    anchor: float


@compiled
def restrained(
    of: Restraint, spring: Spring, before: RestraintState, y: float, dy: float, h: float
) -> tuple[float, float]:
    """Return the force [N] at y after a displacement dy within h seconds, and its slope [N/mm]."""
    k = spring.stiffness_N_per_mm
    force, slope = of.damping_N_s_per_mm * dy / h, of.damping_N_s_per_mm / h
    force += of.hysteresis_N * dahl(dy, before.bristle, of.hysteresis_mm, 0.0, 1.0)
    slope += of.hysteresis_N * dahl_slope(dy, before.bristle, of.hysteresis_mm, 0.0, 1.0)
    relaxing, kept = of.relaxing_share * k, _kept(h, of.relaxing_s)
    force += relaxing * (before.relaxing * exp(-h / of.relaxing_s) + dy * kept)
    slope += relaxing * kept
    wave, steeper = eccentric(
        y,
        of.ripple_sine_mm,
        of.ripple_cosine_mm,
        of.ripple_period_mm,
        of.ripple_second_sine,
        of.ripple_second_cosine,
    )
    force += k * wave
    slope += k * steeper
    anchor = _anchor(of, spring, before.anchor, y)
    force -= k * anchor
    if anchor != before.anchor and 0.0 < anchor < of.clamp_play_mm:
        slope -= k
    return force, slope


@compiled
def held(
    of: Restraint, spring: Spring, before: RestraintState, y: float, dy: float, h: float
) -> RestraintState:
    """Return the state after the load has gone to y by dy within h seconds."""
    return RestraintState(
        dahl(dy, before.bristle, of.hysteresis_mm, 0.0, 1.0),
        before.relaxing * exp(-h / of.relaxing_s) + dy * _kept(h, of.relaxing_s),
        _anchor(of, spring, before.anchor, y),
    )


@compiled
def _kept(h: float, time: float) -> float:
    """Return what share of an even stretch within h seconds has not relaxed by their end."""
    return float(-np.expm1(-h / time) * time / h)


@compiled
def _anchor(of: Restraint, spring: Spring, before: float, y: float) -> float:
    """Return where the anchor is in its slot [mm] once the load is at y."""
    up = (of.clamp_up_N - spring.preload_N) / spring.stiffness_N_per_mm
    down = (of.clamp_down_N - spring.preload_N) / spring.stiffness_N_per_mm
    return min(max(before, min(y - up, of.clamp_play_mm)), max(y - down, 0.0))
