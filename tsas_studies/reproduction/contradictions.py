"""Where the paper contradicts itself or its rig: nine places, each with its evidence.

"Differs" in these rows is the contradiction; a row that agrees would say that it is gone.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from tsas_cli.paper import Paper
from tsas_studies.reproduction.contradictions_of_model import (
    biased,
    free_tendon,
    ill_posed,
    last_lump,
)
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.rig import kr_per_km
from tsas_studies.reproduction.table_3 import lumped_stiffness
from tsas_studies.reproduction.tables_1_2_4 import GREEK, phi
from tsas_studies.reproduction.verdicts import holds, to_the_digit, within

LEAD_PERCENT = 5.0
CONTROLLERS = {
    "pid": "PID",
    "sliding_mode": "sliding mode",
    "adaptive_sliding_mode": "adaptive sliding mode",
}


def contradictions(paper: Paper) -> Group:
    """Return the nine contradictions, numbered."""
    found: tuple[Iterable[Row], ...] = (
        [_misplaced(paper)],
        [_bore(paper)],
        last_lump(paper),
        _excluded(paper),
        _drive_without_reaction(paper),
        _swapped(paper),
        free_tendon(paper),
        biased(paper),
        ill_posed(paper),
    )
    return Group(
        "contradictions",
        "Where the paper contradicts itself or its rig",
        ("Nine places, some with several rows. Where a row differs, that is the contradiction.",),
        tuple(
            replace(row, what=f"{number}. {row.what}")
            for number, rows in enumerate(found, 1)
            for row in rows
        ),
    )


def _misplaced(paper: Paper) -> Row:
    km, factor = lumped_stiffness(paper), kr_per_km(paper)
    printed, kr = paper["stiffness.theory.kr_contraction"], factor * km["contraction"]
    others = ", ".join(
        f"{factor * km[phase]:.4g} (printed {paper[f'stiffness.theory.kr_{phase}'].value:g})"
        for phase in ("dead_band", "loosening")
    )
    return to_the_digit(
        "kr of contraction follows from km",
        printed,
        kr,
        because=f"the printed number is {printed.value / kr:.4g} times what Eq. (34) gives",
        evidence=f"The same factor of {factor:.6f} gives the other two: {others}.",
    )


def _bore(paper: Paper) -> Row:
    bore, tendon = paper["rig.sheath_inner_diameter"], paper.value("rig.tendon_diameter")
    return holds(
        "The tendon fits into the sheath",
        bore.source,
        true=bore.value > tendon,
        criterion="with a bore wider than the tendon",
        unit=bore.unit,
        paper=bore.value,
        ours=tendon,
        because=f"the bore is {tendon - bore.value:.1f} mm narrower than the tendon",
        evidence=f"Bore {bore.value:g} mm, tendon {tendon:g} mm, both of Table 1; km of the dead "
        f"band needs the {tendon:g} mm: with {bore.value:g} mm it would be "
        f"{lumped_stiffness(paper)['dead_band'] * (bore.value / tendon) ** 2:.0f} instead of "
        f"{paper.value('stiffness.theory.km_dead_band'):g} N/mm.",
    )


def _excluded(paper: Paper) -> Iterator[Row]:
    """4: Table 4's bounds against what Eq. (37) gives for the chosen kr."""
    for name, value in phi(paper).items():
        lower, upper = paper[f"adaptation.{name}.lower"], paper[f"adaptation.{name}.upper"]
        start = paper.value(f"adaptation.{name}.initial")
        near = lower if value < lower.value else upper
        side = "below the lower" if near is lower else "above the upper"
        yield holds(
            f"{GREEK[name]} of Eq. (37) lies inside the bounds of Table 4",
            f"{lower.source}, Eq. (37)",
            true=lower.value <= value <= upper.value,
            criterion=f"in lying between {lower.value:g} and {upper.value:g}",
            unit=lower.unit,
            paper=near.value if not lower.value <= value <= upper.value else start,
            ours=value,
            because=f"it is {side} bound of {near.value:g}, {value / near.value:.2g} of it",
            evidence=f"From kr = {paper.value('stiffness.chosen.kr'):g} N/(s rpm) and the "
            f"text's J, B and kL; the start, {start:g}, is {start / value:.3g} times that.",
        )


def _drive_without_reaction(paper: Paper) -> list[Row]:
    """5: φ2 of the identified inverse against Eq. (37), and with the drive's own stiffness."""
    lead, kinematics = paper["feedforward.lead"], 1.0 / kr_per_km(paper)
    kL, km = paper.value("rig.load_stiffness"), paper.value("stiffness.chosen.km")
    kr = km / kinematics
    without, with_it = kL / kr, (kL + km) / kr
    return [
        within(
            "φ2 of the identified inverse is kL/kr",
            lead,
            without,
            percent=LEAD_PERCENT,
            because="Eq. (25) pushes the tendon by km times the motor's position, whatever the "
            f"tendon does; the identified φ2 is {lead.value / without:.0f} times larger",
            evidence=f"kL/kr = {kL:g}/{kr:.4f} = {without:.3f}; Eq. (47) has {lead.value:g}.",
        ),
        within(
            "φ2 of the identified inverse is (kL + km)/kr: the drive's stiffness reacts on x_in",
            lead,
            with_it,
            percent=LEAD_PERCENT,
            because="the drive's stiffness explains another φ2",
            evidence=f"km (x_motor − x_in) in place of km x_motor gives {without:.2f} + "
            f"{km / kr:.2f} = {with_it:.2f}; km/kr is 60 im/(2π r1) = {kinematics:.4f} for any km, "
            "kinematics alone.",
        ),
    ]


def _swapped(paper: Paper) -> Iterator[Row]:
    """6: RMS errors fall with the disturbance while the largest errors grow."""
    for name, words in CONTROLLERS.items():
        rms = [paper.value(f"tracking.{case}.rmse_{name}") for case in ("undisturbed", "disturbed")]
        largest = [
            max(
                abs(paper.value(f"tracking.{case}.{side}_error_{name}"))
                for side in ("lowest", "highest")
            )
            for case in ("undisturbed", "disturbed")
        ]
        growth, of_rms = largest[1] / largest[0], rms[1] / rms[0]
        peak = [one / other for one, other in zip(largest, rms, strict=True)]
        yield holds(
            f"With the disturbance RMSE and largest error grow together, {words}",
            "Table 5; Figs. 10 and 11, text",
            true=(growth > 1.0) == (of_rms > 1.0),
            criterion="in both being above or both below 1",
            unit="1",
            paper=of_rms,
            ours=growth,
            because=f"RMSE becomes {of_rms:.2f} times what it was, and the largest error "
            f"{growth:.2f} times",
            evidence=f"RMSE {rms[0]:g} to {rms[1]:g} N, largest error {largest[0]:g} to "
            f"{largest[1]:g} N: {peak[0]:.1f} and {peak[1]:.1f} times RMSE.",
        )
