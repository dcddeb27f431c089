"""The nominal model of a diagnosis, whose tendon is as stiff as its data sheet says.

Nothing in the catalogue makes a tendon stiffer: where the data fit a much stiffer one, its data
sheet is wrong. A softer one is as a sheath that yields (`sheath_compression`).
"""

from collections.abc import Sequence

from tsas_cli.diagnosis.faults.search import LEAST_EXCESS, explains
from tsas_cli.diagnosis.faults.words import stiffer_tendon
from tsas_cli.identification.against_data_sheet import TENDON
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import FittedModel, solve_fit
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.diagnosis import RecordingFault

PLAUSIBLE = 0.15  # relative deviation of a tendon's axial stiffness from its data sheet


def nominal_fit(
    manifest: Manifest, stated: Model, runs: Sequence[Prepared], *, bounded: bool = True
) -> FitProblem:
    """Return the fit of the nominal parameters; the tendon is `bounded` by its data sheet.

    Not where the length of a sheath is unknown: the data show the stiffness over it.
    """
    segments = [segment(run) for run in runs]
    measured = [slopes_of(run, parts) for run, parts in zip(runs, segments, strict=True)]
    plausible = {}
    stiffness = data_sheet(manifest).value(TENDON)
    if bounded and stiffness is not None and all(run.run.sheath_length_mm for run in runs):
        plausible[TENDON] = stiffness * (1.0 - PLAUSIBLE), stiffness / (1.0 - PLAUSIBLE)
    return base_fit(stated, runs, segments, measured, plausible)


def stiffer_than_stated(
    manifest: Manifest, stated: Model, base: FittedModel, nominal: HypothesisFit
) -> tuple[RecordingFault, float] | None:
    """Return that the tendon is stiffer than its data sheet, and the share that this explains.

    None where it is not, or explains less of what the `nominal` fit leaves beyond the noise than a
    fault of one run would have to.
    """
    stiffness, excess = data_sheet(manifest).value(TENDON), nominal.mean_square - 1.0
    bound = [e for e in base.model.estimates if e.name == TENDON and e.at_bound]
    if stiffness is None or excess < LEAST_EXCESS or not any(e.value > stiffness for e in bound):
        return None
    free = solve_fit(nominal_fit(manifest, stated, base.problem.runs, bounded=False))
    if free.fitted is None or not free.fitted.converged:
        return None
    left = bench_of(free).fit([]).mean_square
    share = (nominal.mean_square - left) / excess
    if not explains(share, excess, left):
        return None
    (found,) = (e for e in free.model.estimates if e.name == TENDON)
    return stiffer_tendon(found.value / stiffness), share
