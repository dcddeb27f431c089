import math
import tomllib
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "datasets" / "yang2025"
PRINTED = tomllib.loads((FOLDER / "values.toml").read_text(encoding="utf-8"))


def leaves(content, path=""):
    for key, value in content.items():
        if "value" in value:
            yield f"{path}{key}", value
        else:
            yield from leaves(value, f"{path}{key}.")


ALL = dict(leaves({key: value for key, value in PRINTED.items() if key != "citation"}))


def value(path):
    return ALL[path]["value"]


MU_THETA = value("rig.friction_coefficient") * value("groups.a.total_bend") * math.pi
EA = value("rig.tendon_modulus") * 1e3 * math.pi / 4.0 * value("rig.tendon_diameter") ** 2
KL = value("rig.load_stiffness")
KR_PER_KM = 2.0 * math.pi * value("rig.turntable_radius") / (60.0 * value("rig.gear_ratio"))


def test_every_value_has_a_unit_and_a_source():
    for path, entry in ALL.items():
        assert set(entry) <= {"value", "unit", "source", "note"}, path
        assert isinstance(entry["value"], int | float), path
        assert entry["unit"], path
        assert entry["source"].startswith(("Table ", "Fig. ", "Eq. ", "text, ")), path


def test_the_citation():
    assert PRINTED["citation"]["doi"] == "10.1038/s41598-025-19024-4"
    assert PRINTED["citation"]["doi"] in (FOLDER / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("path", "formula", "half_a_digit"),
    [
        ("stiffness.theory.km_contraction", KL * math.exp(MU_THETA), 5e-4),
        ("stiffness.theory.km_loosening", KL * math.exp(-MU_THETA), 5e-4),
        (
            "stiffness.theory.km_dead_band",
            EA * MU_THETA / value("rig.sheath_length") / math.tanh(MU_THETA / 2.0),
            0.1,
        ),
        ("stiffness.theory.kr_dead_band", 175.1 * KR_PER_KM, 5e-4),
        ("stiffness.theory.kr_loosening", 1.066 * KR_PER_KM, 5e-5),
        ("stiffness.chosen.kr", 52.0 * KR_PER_KM, 5e-3),
        ("rig.sheath_length", 250.0 * math.pi, 0.5),
        ("feedforward.lead", 1.0 / KR_PER_KM, 0.05),
    ],
)
def test_what_is_printed_follows_from_tables_1_and_2(path, formula, half_a_digit):
    assert value(path) == pytest.approx(formula, abs=half_a_digit)


def test_the_contradictions_are_there_and_noted():
    printed = 10.0 * 2.338 * KR_PER_KM
    assert value("stiffness.theory.kr_contraction") == pytest.approx(printed, rel=1e-3)
    kr = value("stiffness.chosen.kr")
    phi1 = value("rig.inertia") / (kr * value("rig.turntable_radius") ** 2)
    assert phi1 < value("adaptation.phi1.lower")
    assert KL / kr < value("adaptation.phi2.lower")
    for controller in ("pid", "sliding_mode", "adaptive_sliding_mode"):
        disturbed = f"tracking.disturbed.rmse_{controller}"
        assert value(disturbed) < value(f"tracking.undisturbed.rmse_{controller}")
        assert "note" in ALL[disturbed]
    for path in (
        "rig.sheath_inner_diameter",
        "rig.micro_damping",
        "stiffness.theory.kr_contraction",
        "stiffness.theory.km_dead_band",
        "stiffness.measured.km_f_b",
        "stiffness.measured.km_c_e",
        "adaptation.phi1.lower",
        "adaptation.phi2.lower",
        "feedforward.lead",
    ):
        assert ALL[path]["note"]
