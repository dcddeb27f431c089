"""Tables 1, 2 and 4: whether their numbers agree with each other and with the text."""

import math
from collections.abc import Iterator

from tsas_cli.paper import Paper
from tsas_cli.physics.closed_form.capstan import dead_band_width
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.rig import bench_rig, kr_per_km, sheath_length_mm, wrap_of
from tsas_studies.reproduction.verdicts import holds, to_the_digit, undetermined, within

STEEL_KG_PER_M3 = 7850.0
STEEL_GPA = 200.0
SHARE_PERCENT = 10.0
KINEMATICS_PERCENT = 0.1
GREEK = {"phi1": "φ1", "phi2": "φ2", "phi3": "φ3"}
ROUNDED_PERCENT = 0.01
BLOCK_KG = 1.0  # for which the constants of the bristles are those of a textbook


def tables_1_2_4(paper: Paper) -> Group:
    """Return what follows from one table for another, or for the text."""
    return Group(
        "tables-1-2-4",
        "Tables 1, 2 and 4: their numbers among each other",
        ("Numbers that follow from others of the tables or of the text.",),
        (
            *_geometry(paper),
            *_tendon(paper),
            _bristles(paper),
            *_bounds(paper),
            *_gains(paper),
            *_widths(paper),
        ),
    )


def phi(paper: Paper) -> dict[str, float]:
    """Return φ1 [rpm s³/mm], φ2 [rpm s/mm] and φ3 [rpm s²/mm] for the chosen kr, Eq. (37)."""
    kr = paper.value("stiffness.chosen.kr")
    return {
        "phi1": paper.value("rig.inertia") / (kr * paper.value("rig.turntable_radius") ** 2),
        "phi2": paper.value("rig.load_stiffness") / kr,
        "phi3": paper.value("rig.drive_damping") / kr,
    }


def _geometry(paper: Paper) -> Iterator[Row]:
    """Yield what length, drive, preload and friction say of each other."""
    yield to_the_digit(
        "Sheath's length L = R θ of groups a and b",
        paper["rig.sheath_length"],
        sheath_length_mm(paper, "a"),
        evidence=f"R = {paper.value('groups.a.radius_of_curvature'):g} mm and "
        f"θ = {paper['groups.a.total_bend'].value:g} π of Table 2.",
    )
    yield within(
        "Leading term of the drive's inverse against kinematics, 60 im/(2π r1)",
        paper["feedforward.lead"],
        1.0 / kr_per_km(paper),
        percent=KINEMATICS_PERCENT,
        evidence=f"Speed of the tendon per speed of the motor: {kr_per_km(paper):.7f} mm/s per rpm "
        f"for im = {paper.value('rig.gear_ratio'):g} and r1 = "
        f"{paper.value('rig.turntable_radius'):g} mm, Eq. (48).",
    )
    mean, amplitude = paper.value("reference.mean"), paper.value("reference.amplitude")
    yield to_the_digit(
        "The reference of Figs. 9 to 11 begins at the preload",
        paper["rig.preload"],
        mean - amplitude,
        evidence=f"{mean:g} − {amplitude:g} N.",
    )
    yield to_the_digit(
        "Friction coefficient of the static model is that of the dynamic one in motion",
        paper["rig.friction_coefficient"],
        paper.value("rig.dynamic_friction_coefficient"),
        evidence=f"At rest it is {paper.value('rig.static_friction_coefficient'):g}.",
    )


def _tendon(paper: Paper) -> list[Row]:
    area_mm2 = math.pi / 4.0 * paper.value("rig.tendon_diameter") ** 2
    solid = STEEL_KG_PER_M3 * 1e-6 * area_mm2 * 100.0  # kg per 100 m
    density, modulus = paper["rig.linear_density"], paper["rig.tendon_modulus"].value
    by_mass, by_modulus = density.value / solid, modulus / STEEL_GPA
    return [
        within(
            "Linear density of a solid steel tendon",
            density,
            solid,
            percent=SHARE_PERCENT,
            because=f"steel fills {100.0 * by_mass:.0f} % of the cross-section; the tendon is a "
            "strand",
            evidence=f"π/4 · ({paper.value('rig.tendon_diameter'):g} mm)² at "
            f"{STEEL_KG_PER_M3:g} kg/m³.",
        ),
        within(
            "Linear density that goes with the modulus of the strand",
            density,
            solid * by_modulus,
            percent=SHARE_PERCENT,
            because="the shares of steel by weight and by stiffness differ",
            evidence=f"Steel's share of the cross-section: {by_mass:.2f} by weight, "
            f"{by_modulus:.2f} by the modulus ({modulus:g} of {STEEL_GPA:g} GPa).",
        ),
    ]


def _bristles(paper: Paper) -> Row:
    """Say where σ1 comes from: √(σ0 m) of a block of 1 kg, in N s/mm."""
    sigma0, sigma1 = paper.value("rig.bristle_stiffness"), paper["rig.micro_damping"]
    per_mm = paper.value("rig.linear_density") * 1e-5
    lump_kg = per_mm * sheath_length_mm(paper, "a") / paper.value("rig.microelements")
    critical = 2.0 * math.sqrt(1e-3 * sigma0 * lump_kg)
    return within(
        f"Damping of the bristles is √(σ0 · {BLOCK_KG:g} kg)",
        sigma1,
        math.sqrt(1e-3 * sigma0 * BLOCK_KG),
        percent=ROUNDED_PERCENT,
        evidence=f"A lump of this tendon weighs {1e6 * lump_kg:.0f} mg: its critical damping is "
        f"{critical:.4f} N s/mm, so Table 1's is {sigma1.value / critical:.0f} times that.",
    )


def _bounds(paper: Paper) -> Iterator[Row]:
    for name, value in phi(paper).items():
        initial, lower, upper = (
            paper[f"adaptation.{name}.{kind}"].value for kind in ("initial", "lower", "upper")
        )
        low, high = lower / initial, upper / initial
        yield holds(
            f"{GREEK[name]}: the bounds are a tenth and ten times the start",
            "Table 4",
            true=math.isclose(low, 0.1) and math.isclose(high, 10.0),
            criterion="exactly",
            because=f"they are {low:g} and {high:g} times the start",
            evidence=f"{lower:g}, {initial:g} and {upper:g}; Eq. (37) gives {value:.3g}.",
        )


def _gains(paper: Paper) -> list[Row]:
    """Judge "the parameters of the proposed ASMCC were consistent with those of the SMCC"."""
    return [
        to_the_digit(
            f"{gain} of the adaptive controller is that of the sliding mode controller",
            paper[f"controllers.adaptive_sliding_mode.{gain}"],
            paper.value(f"controllers.sliding_mode.{gain}"),
            because="the text gives each controller a value of its own, and then says that they "
            "are the same",
            evidence="; ".join(
                f"{words}: c1 {paper.value(f'controllers.{name}.c1'):g}, "
                f"ks {paper.value(f'controllers.{name}.ks'):g}"
                for name, words in (
                    ("adaptive_sliding_mode", "Adaptive"),
                    ("sliding_mode", "sliding mode"),
                )
            )
            + ".",
        )
        for gain in ("c1", "ks")
    ]


def _widths(paper: Paper) -> Iterator[Row]:
    """Return how far the drive goes in a dead band of the inverse model, at either end."""
    rig, mean = bench_rig(paper), paper.value("reference.mean")
    for tension in (rig.preload_N, mean + paper.value("reference.amplitude")):
        width = dead_band_width(tension, wrap_of(rig), rig.sheath_length_mm, rig.tendon_stiffness_N)
        share = 100.0 * width / (2.0 * paper.value("rig.input_amplitude"))
        yield undetermined(
            f"Width of the dead band at f_out = {tension:g} N",
            "Eqs. (22), (27) to (29)",
            unit="mm",
            ours=width,
            because="the paper prints none",
            evidence=f"F L (e^a + e^−a − 2)/(a EA); {share:.1f} % of the stroke of Fig. 4.",
        )
