"""The parameters of one rig during one run, as arguments of the kernels."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from tsas_cli.effects import Effects
from tsas_cli.physics.bristles import Bristles


class Rig(NamedTuple):
    """One tendon in its sheath with its load (the paper's symbols in brackets).

    Displacements are zero where the tension is the preload everywhere (Yang 2025, point a of
    Fig. 6); the two zeros are the readings of the sensors there.
    """

    friction_coefficient: float  # [μ, 1]
    tendon_stiffness_N: float  # [EA]
    load_stiffness_N_per_mm: float  # [kL]
    sheath_length_mm: float  # [L]
    total_bend_rad: float  # [θ]
    preload_N: float  # [F0]
    x_in_zero_mm: float = 0.0
    x_out_zero_mm: float = 0.0
    bend_slope: float = 0.0  # share by which length per bend angle rises from drive to load
    bend_bow: float = 0.0  # and to both ends (amplitudes of Legendre's P₁ and P₂)
    effects: Effects = Effects()
    bristles: Bristles = Bristles()  # of the dynamic model


def with_values(rig: Rig, values: Mapping[str, float]) -> Rig:
    """Return the rig with some values replaced.

    Names are effect.parameter for effects and bristles.parameter for the dynamic model.
    """
    own: dict[str, Any] = {}
    grouped: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        group, dot, parameter = name.partition(".")
        if dot:
            grouped.setdefault(group, {})[parameter] = value
        else:
            own[name] = value
    if (bristles := grouped.pop("bristles", None)) is not None:
        own["bristles"] = rig.bristles._replace(**bristles)
    if grouped:
        changed = {group: getattr(rig.effects, group)._replace(**v) for group, v in grouped.items()}
        own["effects"] = rig.effects._replace(**changed)
    return rig._replace(**own)
