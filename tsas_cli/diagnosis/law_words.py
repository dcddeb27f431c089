"""What a law of unnamed origin says, in numbers and in a sentence made from the law itself."""

from collections.abc import Mapping

import numpy as np

from tsas_cli.diagnosis.law import CHANGES, Law
from tsas_cli.effects import LAWS
from tsas_cli.numerics.stops import ELEMENTS, KNOTS, widths_of
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records import diagnosis as records
from tsas_cli.records.base import Value
from tsas_cli.support.arrays import Floats

BUILT_UP = 0.9  # share of the change after a reversal that has happened once it is built up
POINTS = 60  # of a drawn curve
LEAST = 0.1  # of the largest part of a law, below which a part is not worth a clause


def records_of(law: Law) -> tuple[records.DescribedLaw, ...]:
    """Return the records of the laws that describe what is left."""
    return tuple(_record(law, name) for name in law.names)


def _record(law: Law, name: str) -> records.DescribedLaw:
    effect = next(e for e in LAWS if e.name == name)
    own = {e.name.split(".")[1]: e for e in law.estimates if e.name.startswith(f"{name}.")}
    value = {parameter: e.value for parameter, e in own.items()}
    channel = CHANGES[name]
    travel = np.concatenate(([0.0], np.geomspace(*_ends(value), POINTS)))
    places = np.linspace(value["low_mm"], value["high_mm"], KNOTS)
    tensions = tensions_of(law)
    return records.DescribedLaw(
        law=name,
        title=effect.title,
        equation=effect.equation,
        sentence=sentence_of(name, value, tensions),
        parameters={p: Value.model_validate(e, from_attributes=True) for p, e in own.items()},
        channel=channel,
        unit=BY_NAME[channel].unit,
        rmse_before=law.before.rmse[channel],
        rmse_after=law.after.rmse[channel],
        travel_mm=tuple(travel),
        after_reversal=tuple(after_reversal(name, value, travel, float(np.mean(tensions)))),
        place_mm=tuple(places),
        along_stroke=tuple(_heights(value)),
    )


def tensions_of(law: Law) -> tuple[float, float]:
    """Return the lowest and the highest simulated tension at the drive [N]."""
    runs = law.bench.errors_for(law.trial)
    predicted = [run.predict(law.bench.rig(law.trial, k))["f_in_N"] for k, run in enumerate(runs)]
    return min(float(p.min()) for p in predicted), max(float(p.max()) for p in predicted)


def weights_of(name: str, value: Mapping[str, float], tension: float) -> Floats:
    """Return the weight of each element at a tension, in the unit of the law's channel."""
    if name == "load_law":
        return np.array([value[f"lost_{k}_mm"] for k in range(1, ELEMENTS + 1)])
    return np.array(
        [value[f"friction_{k}_N"] + value[f"share_{k}"] * tension for k in range(1, ELEMENTS + 1)]
    )


def after_reversal(name: str, value: Mapping[str, float], travel: Floats, tension: float) -> Floats:
    """Return the change after a reversal from one full slip towards the other, over the travel."""
    moved = np.minimum(travel[:, None] / widths_of(value["travel_mm"]), 2.0)
    change: Floats = moved @ weights_of(name, value, tension)
    return change


def sentence_of(name: str, value: Mapping[str, float], tensions: tuple[float, float]) -> str:
    """Return what a law says, in words and numbers."""
    low, high = sorted(2.0 * float(weights_of(name, value, t).sum()) for t in tensions)
    heights = _heights(value)
    span = float(np.ptp(heights))
    travel = np.geomspace(*_ends(value), 400)
    change = after_reversal(name, value, travel, float(np.mean(tensions)))
    built_up = float(travel[np.searchsorted(change, BUILT_UP * change[-1])]) if high > 0.0 else 0.0
    at_drive = name == "drive_law"
    unit = "N" if at_drive else "mm"
    parts = []
    if high > LEAST * span:
        size = f"{low:.2g} to {high:.2g} {unit}" if high > 1.1 * low else f"{high:.2g} {unit}"
        what = "friction changes f_in by" if at_drive else "motion is lost:"
        grows = ", more at higher tension" if high > 1.1 * low else ""
        parts.append(f"{what} {size} after each reversal{grows}, within {built_up:.2g} mm")
    if span > LEAST * high:
        what = "a force changes from" if at_drive else "x_out deviates from"
        parts.append(
            f"{what} {heights[0]:.2g} to {heights[-1]:.2g} {unit} along the stroke"
            if _is_monotone(heights)
            else f"{what} {heights.min():.2g} to {heights.max():.2g} {unit} with the place"
        )
    if not at_drive and value["compliance_mm_per_N"] > 0.0:
        parts.append(f"x_out yields by {value['compliance_mm_per_N']:.2g} mm per N of f_out")
    return f"At the {'drive' if at_drive else 'load'} {'; '.join(parts)}."


def _ends(value: Mapping[str, float]) -> tuple[float, float]:
    """Return a travel below the smallest width, and that after which all elements yield [mm]."""
    widths = widths_of(value["travel_mm"])
    return 0.1 * float(widths[-1]), 2.0 * float(widths[0])


def _heights(value: Mapping[str, float]) -> Floats:
    unit = "N" if "curve_1_N" in value else "mm"
    return np.array([value[f"curve_{k}_{unit}"] for k in range(1, KNOTS + 1)])


def _is_monotone(heights: Floats) -> bool:
    steps = np.diff(heights)
    return bool((steps >= 0.0).all() or (steps <= 0.0).all())
