import tomllib
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "datasets" / "yang2025"
PRINTED = tomllib.loads((FOLDER / "values.toml").read_text(encoding="utf-8"))


def leaves(content, path=""):
    for key, value in content.items():
        if "value" in value:
            yield f"{path}{key}", value
        else:
            yield from leaves(value, f"{path}{key}.")


ALL = dict(leaves({key: value for key, value in PRINTED.items() if key != "citation"}))


def test_every_value_has_a_unit_and_a_source():
    for path, entry in ALL.items():
        assert set(entry) <= {"value", "unit", "source", "note"}, path
        assert isinstance(entry["value"], int | float), path
        assert entry["unit"], path
        assert entry["source"].startswith(("Table ", "Fig. ", "Eq. ", "text, ")), path


def test_the_citation():
    assert PRINTED["citation"]["doi"] == "10.1038/s41598-025-19024-4"
    assert PRINTED["citation"]["doi"] in (FOLDER / "README.md").read_text(encoding="utf-8")


def test_what_contradicts_the_rest_of_the_paper_is_noted():
    """That it does so: tests/studies/reproduction."""
    for controller in ("pid", "sliding_mode", "adaptive_sliding_mode"):
        assert "note" in ALL[f"tracking.disturbed.rmse_{controller}"]
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
