"""What a law of unnamed origin says, in numbers and in a sentence made from the law itself."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from tsas_cli.diagnosis.law import Law
from tsas_cli.diagnosis.law_bench import CHANGES
from tsas_cli.diagnosis.simple_forms import exponential, power, straight_line
from tsas_cli.effects import LAWS
from tsas_cli.effects.laws.drive_law import DriveLaw
from tsas_cli.effects.laws.tendon_law import STARTS
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.numerics.stops import (
    ELEMENTS,
    GAP,
    GAPS,
    KNOTS,
    RATIO,
    beyond_gap,
    widths_of,
    widths_with_gaps,
)
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records import diagnosis as records
from tsas_cli.records.base import TWO_SIDED, Value, number_text
from tsas_cli.support.arrays import Floats

BUILT_UP = 0.9  # share of the change after a reversal from which it is built up
POINTS = 200  # of a drawn curve
LEAST_CHANGE = 0.03  # of friction with speed or place, a share, below which it is not said
LEAST = 0.1  # of the largest part of a law, below which a part is not worth a clause
WHAT = {  # what each law changes, and its unit in the names of its parameters
    "drive_law": ("f_in [N]", "_N"),
    "tendon_law": ("share of the friction", ""),
    "load_law": ("x_out [mm]", "_mm"),
}


def records_of(law: Law) -> tuple[records.DescribedLaw, ...]:
    """Return the records of the laws that describe what is left; a law of nothing has none."""
    tensions = tensions_of(law)
    every = (_record(law, name, tensions) for name in law.names)
    return tuple(record for record in every if record.sentence)


def _record(law: Law, name: str, tensions: tuple[float, float]) -> records.DescribedLaw:
    effect = next(e for e in LAWS if e.name == name)
    own = {e.name.split(".")[1]: e for e in law.estimates if e.name.startswith(f"{name}.")}
    value = {parameter: e.value for parameter, e in own.items()}
    channel = CHANGES[name]
    travel, tension = _travels(value), float(np.mean(tensions))
    turned = partial(after_reversal, name, travel=travel, tension=tension)
    return records.DescribedLaw(
        law=name,
        title=effect.title,
        equation=effect.equation,
        sentence=sentence_of(name, value, tensions),
        parameters={p: Value.model_validate(e, from_attributes=True) for p, e in own.items()},
        rivals=law.rivals,
        beside=law.beside,
        channel=channel,
        unit=BY_NAME[channel].unit,
        rmse_before=law.before.rmse[channel],
        rmse_after=law.after.rmse[channel],
        what=WHAT[name][0],
        travel_mm=tuple(travel),
        after_reversal=tuple(turned(value)),
        after_reversal_margin=tuple(_margin(law, name, turned)),
        place_mm=tuple(np.linspace(value["low_mm"], value["high_mm"], KNOTS)),
        along_stroke=tuple(_heights(name, value)),
        along_stroke_margin=tuple(_margin(law, name, partial(_heights, name))),
    )


def _margin(law: Law, name: str, curve: Callable[[Mapping[str, float]], Floats]) -> Floats:
    """Return half of the 95 % interval of a curve that is linear in a law's parameters, shape (n,).

    Parameters at a bound stay there.
    """
    unknowns = [u.name for u in law.trial.unknowns]
    own = [full for full in unknowns if full.startswith(f"{name}.")]
    zero = {full.split(".")[1]: 0.0 for full in own} | {
        e.name.split(".")[1]: e.value
        for e in law.estimates
        if e.name.startswith(f"{name}.") and e.origin == "given"
    }
    slopes = [curve(zero | {full.split(".")[1]: QUANTITIES[full].size}) for full in own]
    at = [unknowns.index(full) for full in own]
    variance = np.einsum("in,ij,jn->n", slopes, law.covariance[np.ix_(at, at)], slopes)
    return np.asarray(TWO_SIDED * np.sqrt(np.maximum(variance, 0.0)))


def tensions_of(law: Law) -> tuple[float, float]:
    """Return the lowest and the highest tension of the tendon at the drive, not below 0 [N]."""
    f_in = []
    for k, run in enumerate(law.bench.errors_for(law.trial)):
        rig = law.bench.rig(law.trial, k)
        without = rig._replace(effects=rig.effects._replace(drive_law=DriveLaw()))
        f_in.append(run.predict(without)["f_in_N"])
    low, high = min(float(f.min()) for f in f_in), max(float(f.max()) for f in f_in)
    return max(low, 0.0), max(high, 0.0)


def after_reversal(name: str, value: Mapping[str, float], travel: Floats, tension: float) -> Floats:
    """Return the change after a reversal from one full slip towards the other, over the travel."""
    if name == "tendon_law":
        widths = value["travel_mm"] * RATIO ** np.arange(STARTS)
        weights = [value[f"start_{k}"] for k in range(1, STARTS + 1)]
        decaying: Floats = np.exp(-travel[:, None] / widths) @ weights
        return decaying
    left = 1.0 - np.minimum(travel[:, None] / _widths(name, value), 2.0)
    left[:, ELEMENTS:] = beyond_gap(left[:, ELEMENTS:])
    change: Floats = (1.0 - left) @ _weights(name, value, tension)
    return change


def sentence_of(name: str, value: Mapping[str, float], tensions: tuple[float, float]) -> str:
    """Return what a law says, in words and numbers; nothing where it does nothing.

    `tensions` are the lowest and the highest one [N].
    """
    travel = _travels(value)
    change = after_reversal(name, value, travel, float(np.mean(tensions)))
    heights = _heights(name, value)
    if name == "tendon_law":
        parts = _of_friction(travel, change, heights)
        least = LEAST * max(float(np.ptp(heights)), float(np.abs(change).max()))
        parts += _over_speed(value, least)
        return f"In the sheath {'; '.join(parts)}." if parts else ""
    low, high = sorted(2.0 * float(_weights(name, value, t).sum()) for t in tensions)
    span = float(np.ptp(heights))
    parts = []
    if high > LEAST * span:
        within = float(travel[np.searchsorted(change, BUILT_UP * change[-1])])
        if name == "load_law":
            parts.append(f"{_two(high)} mm of the motion are lost at each reversal")
        elif high > 1.1 * low:
            parts.append(
                f"friction changes f_in by {_two(low)} N at low and {_two(high)} N at high tension "
                "after each reversal"
            )
        else:
            parts.append(f"friction changes f_in by {_two(high)} N after each reversal")
        parts[-1] += f", within {_two(within)} mm"
        parts[-1] += exponential(travel, change)
        gap = _gap(name, value, float(np.mean(tensions)))
        parts[-1] += f", hardly over a gap of {_two(gap)} mm in its middle" if gap > 0.0 else ""
        if name == "drive_law":
            parts += [*_over_speed(value, LEAST_CHANGE), *_over_place(value)]
    if span > LEAST * high:
        subject = "a force changes" if name == "drive_law" else "x_out deviates"
        unit = "N" if name == "drive_law" else "mm"
        form = straight_line(heights)
        parts.append(f"{subject} {_along(heights)} {unit} along the stroke{form}")
    yields = value.get("compliance_mm_per_N", 0.0)
    if yields * (tensions[1] - tensions[0]) > LEAST * max(high, span):
        parts.append(f"x_out yields by {_two(yields)} mm per N of f_out")
    where = "drive" if name == "drive_law" else "load"
    return f"At the {where} {'; '.join(parts)}." if parts else ""


def _of_friction(travel: Floats, share: Floats, heights: Floats) -> list[str]:
    """Return the clauses on a friction that differs after a reversal and along the stroke."""
    parts = []
    largest = float(np.abs(share).max())
    if largest > LEAST * np.ptp(heights):
        size = 100.0 * share[int(np.argmax(np.abs(share)))]
        over = float(travel[np.flatnonzero(np.abs(share) > (1.0 - BUILT_UP) * largest)[-1]])
        parts.append(
            f"friction differs by {_two(size)} % after each reversal, over {_two(over)} mm"
            + exponential(travel, share)
        )
    if np.ptp(heights) > LEAST * largest:
        form = straight_line(heights)
        parts.append(f"friction changes {_along(100.0 * heights)} % along the stroke{form}")
    return parts


def _over_speed(value: Mapping[str, float], least: float) -> list[str]:
    """Return the clause on a friction that differs with the speed by more than a share of it."""
    shares = np.array([0.0, value["speed_2"], value["speed_3"]])
    if np.ptp(shares) <= least:
        return []
    ends = f"{_two(value['slow_mm_per_s'])} to {_two(value['fast_mm_per_s'])} mm/s"
    speeds = np.geomspace(value["slow_mm_per_s"], value["fast_mm_per_s"], 3)
    form = power(speeds, 1.0 + shares)
    return [f"friction changes {_along(100.0 * shares)} % from {ends}{form}"]


def _over_place(value: Mapping[str, float]) -> list[str]:
    """Return the clause on a friction that differs along the stroke by more than a share of it."""
    shares = np.array([0.0, *(value[f"place_{k}"] for k in range(2, KNOTS + 1))])
    if np.ptp(shares) <= LEAST_CHANGE:
        return []
    return [f"it changes {_along(100.0 * shares)} % along the stroke{straight_line(shares)}"]


def _two(value: float) -> str:
    """Return a number with two significant digits."""
    return number_text(value, ".2g")


def _gap(name: str, value: Mapping[str, float], tension: float) -> float:
    """Return the gap of the element with a gap that carries most of the friction, else 0 [mm]."""
    weights, widths = _weights(name, value, tension), _widths(name, value)
    largest = int(np.argmax(weights))
    carries = largest >= ELEMENTS and weights[largest] > 0.5 * weights.sum()
    return 2.0 * GAP * float(widths[largest]) if carries else 0.0


def _along(heights: Floats) -> str:
    """Return the ends of a monotone curve, or the extremes of another one."""
    steps = np.diff(heights)
    monotone = (steps >= 0.0).all() or (steps <= 0.0).all()
    first, last = (heights[0], heights[-1]) if monotone else (heights.min(), heights.max())
    ends = _two(first), _two(last)
    return "from {} to {}".format(*ends) if monotone else "between {} and {}".format(*ends)


def _weights(name: str, value: Mapping[str, float], tension: float) -> Floats:
    """Return the weight of each element at a tension, in the unit of the law's channel."""
    if name == "load_law":
        return np.array([value[f"lost_{k}_mm"] for k in range(1, ELEMENTS + 1)])
    elements = [("", k) for k in range(1, ELEMENTS + 1)] + [("gap_", k) for k in range(1, GAPS + 1)]
    return np.array(
        [value[f"{g}friction_{k}_N"] + value[f"{g}share_{k}"] * tension for g, k in elements]
    )


def _widths(name: str, value: Mapping[str, float]) -> Floats:
    """Return the width of each element, in the order of the weights [mm]."""
    widths = widths_of(value["travel_mm"])
    if name == "load_law":
        return widths
    return np.concatenate((widths, widths_with_gaps(value["travel_mm"])))


def _travels(value: Mapping[str, float]) -> Floats:
    """Return travels from below the smallest width to that after which all elements yield [mm]."""
    widths = widths_of(value["travel_mm"])
    return np.concatenate(([0.0], np.geomspace(0.1 * widths[-1], 2.0 * widths[0], POINTS)))


def _heights(name: str, value: Mapping[str, float]) -> Floats:
    """Return the heights of the curve over the place; that of a factor begins at 0.

    That of x_out is about its mean, which its zero takes.
    """
    names = (f"curve_{k}{WHAT[name][1]}" for k in range(1, KNOTS + 1))
    heights = np.array([value.get(name, 0.0) for name in names])
    return heights - heights.mean() if name == "load_law" else heights
