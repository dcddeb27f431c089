import pytest

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality import MANIFEST_CHECKS


def remarks(rig=None, run=None, **top):
    entry = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64}
    entries = run if isinstance(run, list) else [entry | (run or {})]
    content = {"format": 1, "name": "n", "kind": "measured", "rig": rig or {}, "run": entries}
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
    assert remarks(run={"frequency_Hz": 0.5, "tool": "spindle"}) == []  # conditions of one's own


@pytest.mark.parametrize(
    ("rig", "run", "place", "nearest"),
    [
        ({"tendon_diametre_mm": 1.2}, {}, "tendon_diametre_mm in [rig]", "tendon_diameter_mm"),
        ({}, {"preload_n": 25}, "preload_n in run a", "preload_N"),
        ({}, {"friction_coefficient": 0.3}, "friction_coefficient in run a", "move it to [rig]"),
        ({}, {"gear_ratio": 3.0}, "gear_ratio in run a", "move it to [rig]"),
        ({"preload_N": 3.0}, {}, "preload_N in [rig]", "move it to [[run]]"),
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


LIMITS = [
    ("total_bend_rad", 50.01, 49.99, "degree"),
    ("total_bend_rad", 45.0, 46.0, "degree"),  # a round number of degrees
    ("total_bend_rad", 10.0, 5.0, "degree"),
    ("sheath_length_mm", 4.99, 5.0, "metre"),
    ("sheath_length_mm", 50_001.0, 50_000.0, "micrometre"),
    ("tendon_diameter_mm", 0.0199, 0.02, "metre"),
    ("tendon_diameter_mm", 50.1, 50.0, "micrometre"),
    ("tendon_modulus_GPa", 1_001.0, 1_000.0, "MPa"),
    ("tendon_modulus_GPa", 999_999.0, 200.0, "MPa"),
    ("tendon_modulus_GPa", 1e6, 200.0, "Pa"),
    ("friction_coefficient", 3.01, 3.0, "percent"),
    ("turntable_radius_mm", 0.0271, 27.1, "metre"),
    ("turntable_radius_mm", 27_100.0, 5_000.0, "micrometre"),
    ("gear_ratio", 1.0 / 120.0, 0.5, "turns of the pulley for one of the motor"),
    ("inertia_N_mm_s2", 10_001.0, 0.1296, "g cm²"),
    ("proximal_length_mm", 0.49, 0.5, "metre"),
    ("distal_length_mm", 0.01, 0.0, "metre"),
    ("distal_length_mm", 0.49, 0.5, "metre"),
]


@pytest.mark.parametrize(("key", "wrong", "right", "likely"), LIMITS)
def test_a_value_in_another_unit_than_its_key(key, wrong, right, likely):
    run = key in ("total_bend_rad", "sheath_length_mm")
    (remark,), none = (
        [r for code, r in remarks({} if run else {key: v}, {key: v} if run else {})]
        for v in (wrong, right)
    )
    assert remark.sentence.endswith(f"looks like {likely}")
    assert none == []


def test_a_key_in_several_places_is_said_once():
    files = [{"id": i, "file": f"{i}.parquet", "sha256": "0" * 64} for i in "ab"]
    misspelt = [file | {"preload_n": 25} for file in files]
    ((_, remark),) = remarks(run=misspelt)
    assert remark.sentence.endswith("preload_n in run a and 1 more")
    ((_, remark),) = remarks({"grip": 1}, run=[file | {"grip": 1} for file in files])
    assert "the unknown key grip in [rig]" in remark.sentence
