import pytest

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality import MANIFEST_CHECKS


def remarks(rig=None, run=None, **top):
    entry = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64, **(run or {})}
    content = {"format": 1, "name": "n", "kind": "measured", "rig": rig or {}, "run": [entry]}
    manifest = Manifest.model_validate(content | top)
    return [(check.code, remark) for check in MANIFEST_CHECKS for remark in check.find(manifest)]


def test_the_paper_rig_is_ordinary():
    rig = {
        "tendon_diameter_mm": 1.2,
        "tendon_modulus_GPa": 60.0,
        "friction_coefficient": 0.125,
        "load_stiffness_N_per_mm": 1.579,
        "proximal_length_mm": 0.0,
    }
    run = {"sheath_length_mm": 785.4, "total_bend_rad": 3.141593, "preload_N": 25.0}
    assert remarks(rig, run) == []
    assert remarks(run={"total_bend_rad": 31.4159, "sheath_length_mm": 2500.0}) == []


@pytest.mark.parametrize(
    ("rig", "run", "place", "nearest"),
    [
        ({"tendon_diametre_mm": 1.2}, {}, "tendon_diametre_mm in [rig]", "tendon_diameter_mm"),
        ({}, {"preload_n": 25}, "preload_n in run a", "preload_N"),
    ],
)
def test_a_misspelt_key_is_named_with_the_nearest(rig, run, place, nearest):
    ((code, remark),) = remarks(rig, run)
    assert (code, remark.severity) == ("unknown-key", "warning")
    assert place in remark.sentence
    assert nearest in remark.remedy


def test_a_key_of_ones_own_is_a_note_and_cannot_steer_the_terminal():
    ((code, remark),) = remarks(**{"weather\x1b[2J": "fine"})
    assert (code, remark.severity) == ("unknown-key", "note")
    assert "weather\\x1b[2J" in remark.sentence


def test_a_condition_of_ones_own_in_a_run_is_no_finding():
    assert remarks({}, {"frequency_Hz": 0.5, "tool": "spindle"}) == []


@pytest.mark.parametrize(
    ("rig", "run", "likely"),
    [
        ({}, {"total_bend_rad": 180.0}, "degree"),
        ({}, {"total_bend_rad": 45.0}, "degree"),
        ({}, {"sheath_length_mm": 0.785}, "metre"),
        ({"tendon_diameter_mm": 0.0012}, {}, "metre"),
        ({"tendon_modulus_GPa": 6e4}, {}, "MPa"),
        ({"tendon_modulus_GPa": 6e10}, {}, "Pa"),
        ({"friction_coefficient": 12.5}, {}, "percent"),
    ],
)
def test_a_value_in_another_unit_than_its_key(rig, run, likely):
    ((code, remark),) = remarks(rig, run)
    assert code == "manifest-unit"
    assert remark.sentence.endswith(f"looks like {likely}")
