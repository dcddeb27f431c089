"""Table 3: the stiffnesses km and kr of each phase by theory, Eqs. (25) and (29) to (34)."""

import math
from collections.abc import Iterator

from tsas_cli.paper import Paper
from tsas_cli.physics.closed_form.capstan import dead_band_stiffness
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.rig import bench_rig, kr_per_km, stiffness_in_slip, wrap_of
from tsas_studies.reproduction.verdicts import holds, signed, to_the_digit

PHASES = ("contraction", "dead_band", "loosening")
NEGLIGIBLE_PERCENT = 5.0
_WHAT = (
    "km is the slope of the tension over the displacement at the drive, kr = km · 2π r1/(60 im) "
    "how fast the tension rises per speed of the motor; the table prints no unit for kr."
)


def table_3(paper: Paper) -> Group:
    """Return Table 3 by its formulas."""
    km = lumped_stiffness(paper)
    return Group(
        "table-3",
        "Table 3: stiffness by theory",
        (_WHAT,),
        (*_km_rows(paper, km), *_kr_rows(paper, km), *_elastic_rows(paper, km)),
    )


def lumped_stiffness(paper: Paper) -> dict[str, float]:
    """Return km of each phase [N/mm] without the elastic term, Eqs. (29), (31) and (32)."""
    rig = bench_rig(paper)
    kL, a = rig.load_stiffness_N_per_mm, wrap_of(rig)
    return {
        "contraction": kL * math.exp(a),
        "dead_band": dead_band_stiffness(a, rig.sheath_length_mm, rig.tendon_stiffness_N),
        "loosening": kL * math.exp(-a),
    }


def _km_rows(paper: Paper, km: dict[str, float]) -> list[Row]:
    rig = bench_rig(paper)
    formulas = {
        "contraction": "kL e^a, Eq. (31)",
        "dead_band": "(EA a/L) coth(a/2), Eq. (29)",
        "loosening": "kL e^−a, Eq. (32)",
    }
    sizes = (
        f"with a = μθ = {wrap_of(rig):.4f}, EA = {rig.tendon_stiffness_N:.0f} N, "
        f"L = {rig.sheath_length_mm:g} mm, kL = {rig.load_stiffness_N_per_mm:g} N/mm"
    )
    return [
        to_the_digit(
            f"km, {phase.replace('_', ' ')}",
            paper[f"stiffness.theory.km_{phase}"],
            km[phase],
            evidence=f"{formulas[phase]}, {sizes}.",
        )
        for phase in PHASES
    ]


def _kr_rows(paper: Paper, km: dict[str, float]) -> Iterator[Row]:
    factor = kr_per_km(paper)
    for phase in PHASES:
        printed, kr = paper[f"stiffness.theory.kr_{phase}"], factor * km[phase]
        times = printed.value / kr
        yield to_the_digit(
            f"kr, {phase.replace('_', ' ')}",
            printed,
            kr,
            because=f"the printed number is {times:.4g} times what Eq. (34) gives",
            evidence=f"km = {km[phase]:.4g} N/mm times {factor:.6f} mm/s per rpm, Eq. (34).",
        )
    chosen = paper["stiffness.chosen.km"]
    yield to_the_digit(
        "kr, chosen for the controllers",
        paper["stiffness.chosen.kr"],
        factor * chosen.value,
        evidence=f"km = {chosen.value:g} N/mm times {factor:.6f} mm/s per rpm, Eq. (34).",
    )


def _elastic_rows(paper: Paper, km: dict[str, float]) -> Iterator[Row]:
    """Judge the statement that the stretch of the tendon may be left out of Eqs. (30) and (32)."""
    for phase, direction in (("contraction", 1.0), ("loosening", -1.0)):
        kept = stiffness_in_slip(bench_rig(paper), direction)
        off = 100.0 * (km[phase] / kept - 1.0)
        yield holds(
            f"km, {phase}: the elastic term may be neglected",
            "text, Eq. (30)",
            true=abs(off) <= NEGLIGIBLE_PERCENT,
            criterion=f"to {NEGLIGIBLE_PERCENT:g} % of km",
            unit="N/mm",
            paper=km[phase],
            ours=kept,
            because=f"without the term km is {signed(off, 1)} % off",
            evidence=f"With the term km is {kept:.4f}, without it {km[phase]:.4f} N/mm, "
            f"{signed(off, 2)} %.",
        )
