"""Where the paper contradicts itself or its rig: nine places, each with its evidence.

"Differs" in these rows is the contradiction; a row that agrees would say that it is gone.
"""

from dataclasses import replace

from tsas_cli.paper import Paper
from tsas_studies.reproduction.contradictions_of_drive import (
    drive_without_reaction,
    excluded,
    swapped,
)
from tsas_studies.reproduction.contradictions_of_model import (
    biased,
    free_tendon,
    ill_posed,
    last_lump,
)
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.rig import kr_per_km
from tsas_studies.reproduction.table_3 import lumped_stiffness
from tsas_studies.reproduction.verdicts import holds, to_the_digit


def contradictions(paper: Paper) -> Group:
    """Return the nine contradictions, numbered."""
    found = (
        [_misplaced(paper)],
        [_bore(paper)],
        last_lump(paper),
        excluded(paper),
        drive_without_reaction(paper),
        swapped(paper),
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
