"""The parameters of rig and dynamic model: unit, plausible bounds, whether runs share them."""

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
        10.0,  # of μθ, where the bend is unknown
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
        -1e5,
        1e5,
        shared=False,
        positive=False,
        meaning="reading of x_in_mm at the preload",
    ),
    NominalParameter(
        "x_out_zero_mm",
        "mm",
        -1e5,
        1e5,
        shared=False,
        positive=False,
        meaning="reading of x_out_mm at the preload",
    ),
)
BRISTLES = (  # the fields of `bristles.Bristles`
    NominalParameter(
        "stiffness_N_per_mm",
        "N/mm",
        1e-2,
        1e9,
        shared=True,
        positive=True,
        meaning="stiffness of the bristles of the whole sheath, σ0",
    ),
    NominalParameter(
        "damping_N_s_per_mm",
        "N s/mm",
        1e-6,
        1e4,
        shared=True,
        positive=True,
        meaning="damping of the bristles of the whole sheath, σ1; critical where it is not given",
    ),
    NominalParameter(
        "tendon_mass_kg_per_m",
        "kg/m",
        1e-6,
        1e2,
        shared=True,
        positive=True,
        meaning="mass of the tendon per length, ρ",
    ),
    NominalParameter(
        "tendon_damping_N_s_per_mm",
        "N s/mm",
        1e-9,
        1e2,
        shared=True,
        positive=True,
        meaning="damping of the tendon's stretch over the whole sheath, c",
    ),
)
NOMINAL_BY_NAME = {parameter.name: parameter for parameter in NOMINAL}
