"""Unknowns of a fit: nominal parameters of runs, and parameters of bristles and effects."""

from collections.abc import Mapping, Sequence

import numpy as np

from tsas_cli.identification.fit import Unknown
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import LOG_SCALE, QUANTITIES
from tsas_cli.physics.parameters import NOMINAL

FURTHER_SCALE = 7.0  # plausible change without prior knowledge: logarithm, or effect's sizes
ZERO_SCALE = 0.02  # plausible zero of a displacement sensor, of its range


def nominal_unknowns(
    initial: Model, runs: Sequence[Prepared], plausible: Mapping[str, tuple[float, float]]
) -> list[Unknown]:
    """Return all candidates, in the order of the identifiability check.

    With a load other than a spring the preload is equivalent to the zeros: it is fixed.
    """
    out = []
    travel = max((float(np.ptp(r.drive.values)) for r in runs), default=0.0)
    springs = [k for k, run in enumerate(runs) if run.run.load == "spring"]
    for p in NOMINAL:
        owners: Sequence[int | None] = [None] if p.shared else range(len(runs))
        if p.name == "preload_N":
            owners = springs
        if p.name == "load_stiffness_N_per_mm" and not springs:
            continue
        for k in owners:
            value = initial.value(p.name, None if k is None else runs[k].run.id)
            quantity = QUANTITIES[p.name]
            low, high = plausible.get(p.name, (p.lower, p.upper))
            scaled = quantity.scaled(quantity.default if value is None else value)
            scale = LOG_SCALE if p.positive else ZERO_SCALE * travel
            bounds = (quantity.scaled(low), quantity.scaled(high))
            out.append(Unknown(p.name, k, min(max(scaled, bounds[0]), bounds[1]), *bounds, scale))
    return out


def unknown_of(name: str, value: float | None = None, scale: float = 1.0) -> Unknown:
    """Return the unknown of a shared parameter, from a scaled value or its neutral one."""
    quantity = QUANTITIES[name]
    initial = quantity.scaled(quantity.default) if value is None else value
    return Unknown(
        name, None, initial, quantity.scaled(quantity.lower), quantity.scaled(quantity.upper), scale
    )


def further_unknown(name: str, initial: Model) -> Unknown:
    """Return the unknown of a parameter of bristles or effects, from a model's value if any."""
    value = initial.value(name)
    scaled = None if value is None else QUANTITIES[name].scaled(value)
    return unknown_of(name, scaled, FURTHER_SCALE)
