"""One line of the table of stiffnesses: what was measured, and what theory says beside it."""

import math
from types import SimpleNamespace

import pytest

from tests.physics.references import GROUP_A
from tsas_cli.identification.transfer import Slope
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.stages.calibrate import CalibrationResult, _stiffness, _theory

SHEET = {
    "friction_coefficient": 0.125,
    "tendon_modulus_GPa": 60.0,
    "tendon_diameter_mm": 1.2,
    "load_stiffness_N_per_mm": 1.579,
    "turntable_radius_mm": 27.1,
    "gear_ratio": 120.0,
}
CONDITIONS = {"total_bend_rad": math.pi, "sheath_length_mm": 785.0, "preload_N": 25.0}


def stiffness(phase="contraction", sheet=SHEET, conditions=CONDITIONS, expected=2.4):
    run = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64} | conditions
    manifest = Manifest.model_validate(
        {"format": 1, "name": "n", "kind": "measured", "rig": sheet, "run": [run]}
    )
    slope = Slope(phase, 2.35, 0.01, 0.024, 3, 400)
    model = SimpleNamespace(rig=lambda _: GROUP_A._replace(friction_coefficient=0.2))
    beside = None if expected is None else Slope(phase, expected, 0.0, 0.0, 3, 400)
    prepared = SimpleNamespace(run=manifest.run[0])
    return _stiffness(prepared, slope, beside, manifest, model)


def test_measured_stiffness_is_told_per_millimetre_and_per_turn():
    found = stiffness().content()
    km, kr = found["km"], found["kr"]
    assert (km["value"], km["stderr"]) == (2.35, 0.01)
    assert (km["interval_low"], km["interval_high"]) == pytest.approx((2.326, 2.374))
    for name in ("value", "stderr", "interval_low", "interval_high"):
        assert kr[name] == pytest.approx(0.0236492 * km[name], rel=1e-5)  # 2π r1/(60 im)
    assert (km["unit"], kr["unit"]) == ("N/mm", "N/(s rpm)")
    assert (found["occurrences"], found["samples"], found["expected_N_per_mm"]) == (3, 400, 2.4)
    less = stiffness(sheet={k: v for k, v in SHEET.items() if k != "gear_ratio"}, expected=None)
    assert less.expected_N_per_mm is less.kr is None


@pytest.mark.parametrize(
    ("phase", "theory", "elastic"),
    [
        ("contraction", 2.338, 2.287),
        ("loosening", 1.066, 1.050),
        ("dead_band_up", 175.10, 175.10),
        ("dead_band_down", 175.10, 175.10),
    ],
)
def test_theory_is_that_of_the_paper(phase, theory, elastic):
    found = stiffness(phase)
    assert found.theory_N_per_mm == pytest.approx(theory, abs=1e-3 * theory)
    assert found.theory_elastic_N_per_mm == pytest.approx(elastic, abs=1e-3 * elastic)
    assert found.note == "theory from the data sheet"


@pytest.mark.parametrize("missing", list(SHEET)[:4])
def test_without_a_data_sheet_theory_is_that_of_the_calibrated_values(missing):
    found = stiffness(sheet={k: v for k, v in SHEET.items() if k != missing})
    assert found.note == "theory from the calibrated values"
    assert found.theory_N_per_mm == pytest.approx(1.579 * math.exp(0.2 * math.pi))


def test_no_theory_without_friction_or_spring():
    slope = Slope("contraction", 2.0, 0.1, 0.2, 1, 50)
    spring = SimpleNamespace(run=SimpleNamespace(load="spring"))
    weight = SimpleNamespace(run=SimpleNamespace(load="force"))
    assert _theory(GROUP_A._replace(friction_coefficient=0.0), slope, spring) == (None, None)
    assert _theory(GROUP_A, slope, weight) == (None, None)
    assert _theory(GROUP_A, Slope("dead_band_up", 2.0, 0.1, 0.2, 1, 50), weight)[0] > 100.0


def test_the_table_leaves_out_what_is_not_known():
    record = SimpleNamespace(
        stiffness=[stiffness(expected=None)], parameters=[], transfer=[], channels={}
    )
    result = CalibrationResult({}, None, record, None)
    (_, header, (line,)), *others = result.tables()
    assert header[:2] == ("run", "phase")
    assert line == ("a", "contraction", "2.35 [2.326, 2.374]", "2.338", "")
    titles = [title for title, _, _ in others]
    assert titles == ["parameters", "calibrated model against measurement"]
