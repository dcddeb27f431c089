"""The nominal rig's parameters: unit, plausible bounds, and whether runs share them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class NominalParameter:
    """One parameter of the nominal rig.

    A positive one is fitted by its logarithm. One that is not shared has a value for each run.
    """

    name: str
    unit: str
    lower: float
    upper: float
    shared: bool
    positive: bool
    meaning: str


NOMINAL = (
    NominalParameter(
        "friction_coefficient",
        "1",
        1e-4,
        10.0,  # μθ where the bend is not known
        shared=True,
        positive=True,
        meaning="friction between tendon and sheath, μ",
    ),
    NominalParameter(
        "load_stiffness_N_per_mm",
        "N/mm",
        1e-4,
        1e4,
        shared=True,
        positive=True,
        meaning="stiffness of the load spring, kL",
    ),
    NominalParameter(
        "preload_N",
        "N",
        1e-3,
        1e5,
        shared=False,
        positive=True,
        meaning="tension everywhere where the displacements are zero, F0",
    ),
    NominalParameter(
        "tendon_stiffness_N",
        "N",
        1e1,
        1e8,
        shared=True,
        positive=True,
        meaning="axial stiffness of the tendon, EA",
    ),
    NominalParameter(
        "x_in_zero_mm",
        "mm",
        -1e3,
        1e3,
        shared=False,
        positive=False,
        meaning="what x_in_mm reads at the preload",
    ),
    NominalParameter(
        "x_out_zero_mm",
        "mm",
        -1e3,
        1e3,
        shared=False,
        positive=False,
        meaning="what x_out_mm reads at the preload",
    ),
)
NOMINAL_BY_NAME = {parameter.name: parameter for parameter in NOMINAL}
