"""The parameters of rig and dynamic model: unit, plausible bounds, whether runs share them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class NominalParameter:
    """One parameter of the nominal rig; one that is not shared has a value for each run."""

    name: str
    unit: str
    lower: float
    upper: float
    shared: bool = True

    @property
    def positive(self) -> bool:
        """Whether it is fitted by its logarithm."""
        return self.lower > 0.0


NOMINAL = (
    NominalParameter("friction_coefficient", "1", 1e-4, 10.0),  # μ; μθ where θ is unknown
    NominalParameter("load_stiffness_N_per_mm", "N/mm", 1e-4, 1e4),  # of the load spring, kL
    NominalParameter("preload_N", "N", 1e-3, 1e5, shared=False),  # at zero displacements, F0
    NominalParameter("tendon_stiffness_N", "N", 1e1, 1e8),  # axial, EA
    NominalParameter("x_in_zero_mm", "mm", -1e5, 1e5, shared=False),  # reading at the preload
    NominalParameter("x_out_zero_mm", "mm", -1e5, 1e5, shared=False),
)
BRISTLES = (  # the fields of `bristles.Bristles`
    NominalParameter("stiffness_N_per_mm", "N/mm", 1e-2, 1e9),
    NominalParameter("damping_N_s_per_mm", "N s/mm", 1e-6, 1e4),
    NominalParameter("tendon_mass_kg_per_m", "kg/m", 1e-6, 1e2),
    NominalParameter("tendon_damping_N_s_per_mm", "N s/mm", 1e-9, 1e2),
)
NOMINAL_BY_NAME = {parameter.name: parameter for parameter in NOMINAL}
