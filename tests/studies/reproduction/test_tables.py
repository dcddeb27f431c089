"""Tables 1 to 4 against numbers worked out by hand from the formulas."""

import math

import pytest

from tsas_cli.paper import yang2025
from tsas_studies.reproduction.rig import kr_per_km
from tsas_studies.reproduction.table_3 import table_3
from tsas_studies.reproduction.tables_1_2_4 import tables_1_2_4

PAPER = yang2025()


def rows_of(group):
    rows = {row.what: row for row in group.rows}
    assert len(rows) == len(group.rows)
    return rows


TABLE_3, TABLES = rows_of(table_3(PAPER)), rows_of(tables_1_2_4(PAPER))


@pytest.mark.parametrize(
    ("what", "ours", "verdict"),
    [
        ("km, contraction", 2.338, "agrees"),
        ("km, dead band", 175.10, "agrees"),
        ("km, loosening", 1.066, "agrees"),
        ("kr, contraction", 0.0553, "differs"),
        ("kr, dead band", 4.141, "agrees"),
        ("kr, loosening", 0.0252, "agrees"),
        ("kr, chosen for the controllers", 1.230, "agrees"),
        ("km, contraction: the elastic term may be neglected", 2.287, "agrees"),
        ("km, loosening: the elastic term may be neglected", 1.050, "agrees"),
    ],
)
def test_table_3(what, ours, verdict):
    assert TABLE_3[what].ours == pytest.approx(ours, rel=1e-3)
    assert TABLE_3[what].verdict == verdict


def test_kr_of_contraction_is_printed_ten_times_too_large():
    row = TABLE_3["kr, contraction"]
    assert row.ratio == pytest.approx(0.1, rel=1e-3)
    assert "10 times" in row.because


@pytest.mark.parametrize(
    ("name", "value", "turned"),
    [
        ("stiffness.theory.km_contraction", 2.339, {"km, contraction"}),
        ("stiffness.theory.km_dead_band", 175.2, {"km, dead band"}),
        ("stiffness.theory.km_loosening", 1.067, {"km, loosening"}),
        ("stiffness.theory.kr_contraction", 0.0553, {"kr, contraction"}),
        ("stiffness.theory.kr_dead_band", 4.142, {"kr, dead band"}),
        ("stiffness.theory.kr_loosening", 0.0253, {"kr, loosening"}),
        ("stiffness.chosen.kr", 1.24, {"kr, chosen for the controllers"}),
    ],
)
def test_another_printed_value_turns_its_verdict(name, value, turned):
    rows = rows_of(table_3(PAPER.with_value(name, value)))
    assert {what for what in rows if rows[what].verdict != TABLE_3[what].verdict} == turned


def test_radius_and_gear_ratio_are_not_swapped():
    assert kr_per_km(PAPER) == pytest.approx(0.0236492, abs=5e-8)
    assert 1.0 / kr_per_km(PAPER) == pytest.approx(42.2847, abs=5e-5)
    swapped = PAPER.with_value("rig.turntable_radius", 120.0).with_value("rig.gear_ratio", 27.1)
    assert rows_of(table_3(swapped))["kr, dead band"].verdict == "differs"


def test_friction_and_bend_give_the_exponent_and_load_and_tendon_are_not_swapped():
    soft = PAPER.with_value("rig.load_stiffness", 1.7)
    turned = {w for w, row in rows_of(table_3(soft)).items() if row.verdict != TABLE_3[w].verdict}
    assert turned == {"km, contraction", "km, loosening", "kr, loosening"}
    thick = PAPER.with_value("rig.tendon_diameter", 1.3)
    turned = {w for w, row in rows_of(table_3(thick)).items() if row.verdict != TABLE_3[w].verdict}
    assert turned == {"km, dead band", "kr, dead band"}


def test_widths_of_the_dead_band():
    assert TABLES["Width of the dead band at f_out = 25 N"].ours == pytest.approx(0.115, abs=5e-4)
    assert TABLES["Width of the dead band at f_out = 61 N"].ours == pytest.approx(0.281, abs=5e-4)


def test_the_tendon_is_a_strand():
    row = TABLES["Linear density of a solid steel tendon"]
    assert row.ours == pytest.approx(0.89, abs=5e-3)
    assert row.verdict == "differs"
    assert "28 %" in row.because


def test_the_bristles_are_those_of_a_block_of_1_kg():
    row = TABLES["Damping of the bristles is √(σ0 · 1 kg)"]
    assert row.ours == pytest.approx(1e-3 * math.sqrt(1e5), rel=1e-12)
    assert row.verdict == "agrees"
    assert "80 times" in row.evidence


@pytest.mark.parametrize(
    ("name", "value", "what"),
    [
        ("rig.sheath_length", 786.0, "Sheath's length L = R θ of groups a and b"),
        (
            "feedforward.lead",
            42.0,
            "Leading term of the drive's inverse against kinematics, 60 im/(2π r1)",
        ),
        ("reference.mean", 44.0, "The reference of Figs. 9 to 11 begins at the preload"),
        ("adaptation.phi2.upper", 18.5, "φ2: the bounds are a tenth and ten times the start"),
        ("rig.micro_damping", 0.3163, "Damping of the bristles is √(σ0 · 1 kg)"),
        (
            "controllers.adaptive_sliding_mode.ks",
            1200.0,
            "ks of the adaptive controller is that of the sliding mode controller",
        ),
    ],
)
def test_another_value_turns_the_verdict_of_tables_1_2_4(name, value, what):
    rows = rows_of(tables_1_2_4(PAPER.with_value(name, value)))
    assert rows[what].verdict != TABLES[what].verdict
