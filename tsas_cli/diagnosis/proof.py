"""What a named effect has to prove, besides its gain on held-out data.

It has one value wherever the recordings determine it, which is not that of a rig without the
effect and not the limit of what is plausible, and it makes no channel worse on held-out data. An
effect that gains and fails one of these stands in for something that the catalogue does not have.
One that explains nearly all, and is about as large everywhere, is there with another law than the
catalogue's.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from tsas_cli.diagnosis.constancy import Split
from tsas_cli.diagnosis.evidence import REPEATS, Reduction
from tsas_cli.diagnosis.refitted import HeldOutFit
from tsas_cli.diagnosis.signals import RUN, signal_in_words
from tsas_cli.effects import EFFECTS, Effect, Parameter
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.records.base import TWO_SIDED, number_text
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

ANOTHER_LAW = 0.05  # share of the excess that an effect of another law leaves at most
LEAST_RISE = 0.03  # relative rise of a channel's RMS on held-out data that refuses a name
RISE_OF_FALL = 0.02  # the same, of its square over what the squares of the others fall by
MOST_PARTS = 4  # of a split that a sentence lists
ALIKE = 0.1  # relative difference of two sensors' errors within which they are alike

# What adds to both forces alike is something else: a law of friction μ(T + c) is the capstan's with
# c added to both, a force along the way that the tendon passes on is a tilt of both, a load that
# softens takes a share of both.
BOTH_SENSORS = {
    "force_sensor_drift": "friction that changes and does not vanish with the tension",
    "force_sensor_gain_drift": "a load whose stiffness changes",
    "force_sensor_hysteresis": "a hysteresis of the load",
    "force_sensor_offset": "friction that does not vanish with the tension",
    "force_sensor_tilt": "a force along the way of the tendon",
}

BY_NAME: Mapping[str, Effect] = {effect.name: effect for effect in EFFECTS}


@dataclass(frozen=True)
class FoundCause:
    """An effect that gains, with its parameters and its reduction of the RMS on held-out data [%].

    `failed` is what it does not prove, in sentences without their subject; empty for a named one.
    `law_differs` says over which signal the law of a named one differs from the catalogue's.
    `convincing` is whether it gains with new fits too, `negligible` whether it is no more than what
    every rig has, or neither gains nor differs from none: then it stands in for nothing.
    """

    effect: str
    rivals: tuple[str, ...]
    parameters: tuple[Estimate, ...]
    gain_percent: float
    gain_interval_percent: tuple[float, float]
    failed: tuple[str, ...] = ()
    law_differs: str = ""
    convincing: bool = True
    negligible: bool = False

    def refused(self, why: str) -> Self:
        """Return the effect with one thing more that it does not prove."""
        return replace(self, failed=(*self.failed, why))


def failures(
    effect: str,
    estimates: Sequence[Estimate],
    refitted_gain: Reduction,
    without: HeldOutFit,
    with_it: HeldOutFit,
    *,
    tolerance_N: Mapping[str, float] | None = None,
    stroke_mm: float = math.inf,
    zero: bool = False,
) -> tuple[str, ...]:
    """Return what an effect fails to prove, in sentences without their subject.

    `refitted_gain` is its reduction of the squares on held-out data by new fits, `without` and
    `with_it` are the errors there. `tolerance_N` is by how much a force sensor of a sound rig may
    be wrong, `stroke_mm` the longest way of the drive, infinite where it is not known, and `zero`
    whether the effect `may_be_zero`.
    """
    own = {e.name.partition(".")[2]: e for e in estimates}
    parameters = {p.name: p for p in BY_NAME[effect].parameters}
    sizes = {name: e for name, e in own.items() if not parameters[name].shape}
    out = []
    if not refitted_gain.convincing:
        out.append("gains too little on held-out data with a new fit")
    out += [
        f"has {name} at the limit of what is plausible ({e.value:.3g} {e.unit})"
        for name, e in own.items()
        if (name in sizes or parameters[name].period)
        and e.at_bound
        and not _is_near_neutral(e.value, parameters[name])
    ]
    out += [
        f"has {name} up to the limit of what is plausible: {e.text()} {_unit(e.unit)}".rstrip()
        for name, e in sizes.items()
        if _reaches_a_limit(e, parameters[name])
    ]
    known = {n: e for n, e in sizes.items() if not _is_unknown(e, parameters[n])}
    if zero or (sizes and not known):
        values = [f"{n} {e.text()} {_unit(e.unit)}".strip() for n, e in known.items()]
        out.append(f"may not be there: {', '.join(values) or 'nothing is known of its size'}")
    out += [
        f"has a period of up to {longest:.3g} mm, which strokes of {stroke_mm:.3g} mm hardly repeat"
        for name, e in own.items()
        if parameters[name].period
        and REPEATS * (longest := max(e.value, e.interval_high or 0.0)) > stroke_mm
    ]
    if effect in BOTH_SENSORS:
        for pair in _of_both_sensors({n: e for n, e in sizes.items() if not e.at_bound}):
            out += _alike_in_both(effect, pair, zero=zero)
    out += _worse_channels(without, with_it, tolerance_N or {})
    return tuple(out)


def _of_both_sensors(sizes: Mapping[str, Estimate]) -> list[tuple[Estimate, Estimate]]:
    """Return the sizes of both force sensors; of several kinds those that are not zero."""
    others = {name: sizes.get(name.replace("f_in", "f_out", 1)) for name in sizes if "f_in" in name}
    pairs = [(sizes[name], other) for name, other in others.items() if other is not None]
    return [pair for pair in pairs if len(pairs) == 1 or not all(e.holds(0.0) for e in pair)]


def _alike_in_both(effect: str, sensors: tuple[Estimate, Estimate], *, zero: bool) -> list[str]:
    """Return that both force sensors are wrong by the same amount, where they are or may be."""
    both = [e.value for e in sensors]
    apart, size = np.ptp(both), abs(np.mean(both))
    near, unsure = apart < ALIKE * size, not zero and all(e.holds(*both) for e in sensors)
    if not (near or (unsure and apart < 2.0 * ALIKE * size)):
        return []
    values = f"{both[0]:.3g} and {both[1]:.3g} {_unit(sensors[0].unit)}".rstrip()
    are = "is" if near else "may be"
    return [f"{are} the same for both sensors ({values}), which {BOTH_SENSORS[effect]} does too"]


def _worse_channels(
    without: HeldOutFit, with_it: HeldOutFit, tolerance_N: Mapping[str, float]
) -> list[str]:
    """Return which channels an effect makes worse.

    Both the RMS and that of the error over the noise rise: the first alone may where a reversal is
    steep.
    """
    changes = {n: after**2 - without.normalised[n] ** 2 for n, after in with_it.normalised.items()}
    fall = -sum(min(change, 0.0) for change in changes.values())
    return [
        f"makes {name} worse on held-out data ({number_text(before)} to {number_text(after)})"
        for (name, before), after in zip(without.rmse.items(), with_it.rmse.values(), strict=True)
        if after > (1.0 + LEAST_RISE) * before
        and changes[name] > RISE_OF_FALL * fall
        and after**2 - before**2 > tolerance_N.get(name, 0.0) ** 2
    ]


def may_be_zero(
    effect: str, estimates: Sequence[Estimate], correlation: Floats | None = None
) -> bool:
    """Return whether the 95 % region of an effect's sizes holds the neutral values (Wald test).

    Two offsets that only their sum is known of may each be zero, and not both. The shape of an
    effect, such as its time constant, is held: without a size it has no meaning (Davies 1977). An
    effect without a size cannot be zero.

    `correlation` is that of the parameters, shape (p, p); None where it is not known.
    """
    from scipy.special import chdtri

    sizes = {f"{effect}.{p.name}": p.neutral for p in BY_NAME[effect].parameters if not p.shape}
    if not any(e.name in sizes for e in estimates):
        return False
    deviations, rows = [], []
    for row, e in enumerate(estimates):
        if e.name not in sizes or e.interval_low is None or e.interval_high is None:
            continue
        away = e.value - sizes[e.name]
        if away == 0.0:
            continue
        low, high = e.value - e.interval_low, e.interval_high - e.value
        half = low if away > 0.0 else high
        if half == abs(away):  # the interval is cut at the neutral value
            half = max(low, high)
        if half == 0.0:  # the interval ends at the value
            return False
        deviations.append(away / half)
        rows.append(row)
    if not rows:
        return True
    related = np.eye(len(estimates)) if correlation is None else correlation
    precision = np.linalg.pinv(related, hermitian=True)[np.ix_(rows, rows)]
    z = TWO_SIDED * np.array(deviations)
    return float(z @ precision @ z) <= float(chdtri(len(rows), 0.05))


def split_in_words(split: Split) -> str:
    """Return the values of a parameter in the parts of a split, in words; of many the extremes."""
    parts = split.values
    if len(parts) > MOST_PARTS:
        parts = tuple(end(parts, key=lambda pair: pair[1]) for end in (min, max))
    shown = [{f"{value:.{n}g}" for _, value in parts} for n in range(3, 7)]
    digits = 3 + next((k for k, texts in enumerate(shown) if len(texts) == len(parts)), 3)
    values = listed([f"{value:.{digits}g} ({part})" for part, value in parts])
    unit = _unit(QUANTITIES[split.parameter].unit)
    over = "from run to run" if split.by == RUN else f"over {signal_in_words(split.by)}"
    return f"{over}: {split.parameter.partition('.')[2]} {values} {unit}".rstrip()


def _unit(unit: str) -> str:
    """Return a unit as a text has it: nothing for a number."""
    return "" if unit == "1" else unit


def _reaches_a_limit(e: Estimate, parameter: Parameter) -> bool:
    """Return whether an interval without the neutral value ends at a limit, and the value not."""
    touches = any(_ends_at_limits(e, parameter))
    return touches and not e.at_bound and not e.holds(parameter.neutral)


def _is_unknown(e: Estimate, parameter: Parameter) -> bool:
    """Return whether all that is plausible is in the interval, as of an unrecorded channel."""
    return all(_ends_at_limits(e, parameter))


def _ends_at_limits(e: Estimate, parameter: Parameter) -> list[bool]:
    """Return whether the lower and the upper end of an interval are limits of what is plausible."""
    ends = (e.interval_low, parameter.lower), (e.interval_high, parameter.upper)
    return [end is not None and math.isclose(end, limit) for end, limit in ends]


def _is_near_neutral(value: float, parameter: Parameter) -> bool:
    """Return whether the bound that is nearer to a value is the neutral value."""
    nearer = min((parameter.lower, parameter.upper), key=lambda bound: abs(bound - value))
    return nearer == parameter.neutral
