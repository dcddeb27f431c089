"""Fitted values that contradict the data sheet are told, with the factor that explains them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.identification.against_data_sheet import contradictions
from tsas_cli.identification.calibration import calibrate_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.recordings.manifest import Manifest
from tsas_studies.challenge.rig.recordings import DATA_SHEET
from tsas_studies.challenge.rig.tendon import Rig

EA = 1e3 * 60.0 * math.pi / 4.0 * 1.2**2  # 67858 N
STATED = {
    "friction_coefficient": (0.125, "1", None),
    "load_stiffness_N_per_mm": (1.579, "N/mm", None),
    "tendon_stiffness_N": (EA, "N", None),
    "preload_N": (25.0, "N", "a"),
}
SHEATH = "sheath_compression.compliance_ratio"


def sheet(**changed):
    run = {"id": "a", "file": "a.parquet", "sha256": "0" * 64, "preload_N": 25.0}
    run |= {"sheath_length_mm": 785.4, "total_bend_rad": 3.1416} | changed
    return Manifest.model_validate(
        {"format": 1, "name": "d", "kind": "measured", "rig": DATA_SHEET, "run": [run]}
    )


def fitted(width=1e-3, **factors):
    """Return a model with the values of the data sheet, times a factor where one is given."""
    estimates = []
    for name, (value, unit, run) in STATED.items():
        at = value * factors.get(name, 1.0)
        ends = at * (1.0 - width), at * (1.0 + width)
        estimates.append(Estimate(name, at, unit, "fitted", run, 0.5 * width * at, *ends))
    return Model(tuple(estimates))


def forces(factor, **others):
    names = ("preload_N", "load_stiffness_N_per_mm", "tendon_stiffness_N")
    return fitted(**(dict.fromkeys(names, factor) | others))


@pytest.mark.parametrize(
    ("factor", "unit"),
    [
        *((1e-3, "kilonewton"), (1 / 9.807, "kilogram-force"), (1 / 4.448, "pound-force")),
        *((factor, None) for factor in (0.5, 0.8, 0.85, 1.15, 1.2, 2.0, 1000.0)),
    ],
)
def test_a_common_factor_of_both_forces_is_told_with_its_interval(factor, unit):
    (said,) = contradictions(sheet(), forces(factor))
    assert said.startswith(f"A common factor of f_in and f_out of {factor:.3g} [")
    low, high = (float(end) for end in said.split("[")[1].split("]")[0].split(", "))
    assert low < factor < high < 1.2 * low
    assert f"explains preload ({25.0 * factor:.3g} for 25 N), load stiffness" in said
    assert f"tendon stiffness ({EA * factor:.3g} for 6.79e+04 N)" in said
    assert "check the unit or the amplifier's gain, or the data sheet." in said
    assert "x_in and x_out" not in said
    assert ("both look like" in said) == (unit is not None)
    assert unit is None or f"(both look like {unit})" in said


@pytest.mark.parametrize("width", [1e-3, 0.1])
@pytest.mark.parametrize("off", [0.9, 1.0, 1.1])
def test_the_interval_of_a_factor_is_of_the_data_sheet_and_the_fit(width, off):
    """A data sheet is off by 10, 5 and 10 %; the fit's errors add in squares, by their weights."""
    (said,) = contradictions(sheet(), forces(0.5, width=width, preload_N=0.5 * off))
    sd_of_fit = math.log((1.0 + width) / (1.0 - width)) / (2.0 * 1.96)
    weights = [1.0 / (stated**2 + sd_of_fit**2) for stated in (0.1, 0.05, 0.1)]
    factor = math.exp(np.average(np.log((0.5 * off, 0.5, 0.5)), weights=weights))
    side = math.exp(1.96 * sum(weights) ** -0.5)
    expected = factor, factor / side, factor * side
    found = said.split(" of ")[2].split("] ")[0].replace(" [", ", ").split(", ")
    assert [float(text) for text in found] == pytest.approx(expected, rel=2e-3)


def contradicted(logs, width=1e-9, **changed):
    """Return what is said of values that are off by given logarithms."""
    factors = {name: math.exp(log) for name, log in logs.items()}
    return contradictions(sheet(**changed), fitted(width=width, **factors))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("preload", "load", "tendon", "common"),
    [
        # Weights of 100, 400, 100: a mean beyond three standard errors, 600^(−1/2) each.
        (0.121, 0.121, 0.121, False),
        (0.124, 0.124, 0.124, True),
        # χ² of two degrees of freedom, δ² 100 · 500 / 600, up to 5.99; of one, δ² 80, to 3.84.
        (0.4 + 0.266, 0.4, 0.4, True),
        (0.4 + 0.270, 0.4, 0.4, False),
        (None, 0.4, 0.4 + 0.218, True),
        (None, 0.4, 0.4 + 0.221, False),
    ],
)
def test_a_factor_is_common_where_it_is_sure_and_values_agree(preload, load, tendon, common, sign):
    logs = {"load_stiffness_N_per_mm": sign * load, "tendon_stiffness_N": sign * tendon}
    logs["preload_N"] = sign * (preload or 0.0)
    said = contradicted(logs, preload_N=None if preload is None else 25.0)
    assert any("common factor of f_in and f_out of" in each for each in said) == common


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("name", "least", "width", "check"),
    [
        ("preload_N", 0.7, 0.05, "preload_N of the manifest, and zero and gain of the force"),
        ("load_stiffness_N_per_mm", 0.85, 1e-3, "load_stiffness_N_per_mm, and unit and gain of"),
        ("friction_coefficient", 0.5, 0.05, "friction_coefficient, total_bend_rad, and the gain"),
        ("tendon_stiffness_N", 0.85, 0.05, ""),
    ],
)
def test_a_value_contradicts_beyond_what_is_tolerated_and_the_fits_own_error(
    name, least, width, check, sign
):
    edge = -math.log(least) + 0.5 * math.log((1.0 + width) / (1.0 - width))
    assert contradicted({name: 0.99 * sign * edge}, width) == []
    (said,) = contradicted({name: 1.01 * sign * edge}, width)
    assert f"is {math.exp(1.01 * sign * edge):.3g} times that of the data sheet:" in said
    assert f"check {check}" in said or not check


@pytest.mark.parametrize("factor", [0.5, 1 / 25.4])
def test_a_common_factor_of_both_displacements_leaves_the_preload(factor):
    names = ("load_stiffness_N_per_mm", "tendon_stiffness_N")
    (said,) = contradictions(sheet(), fitted(**dict.fromkeys(names, 1.0 / factor)))
    assert said.startswith(f"A common factor of x_in and x_out of {factor:.3g} [")
    assert ("both look like inch" in said) == (factor != 0.5)


def test_without_a_stated_preload_either_factor_explains_the_same():
    (said,) = contradictions(sheet(preload_N=None), forces(0.5))
    assert "A common factor of f_in and f_out of 0.5 [" in said
    assert "or a common factor of x_in and x_out of 2 [" in said


@pytest.mark.parametrize("seed", range(8))
def test_what_a_data_sheet_is_off_by_is_silent(seed):
    """By up to a tenth each, in any direction."""
    off = dict(zip(STATED, [1.1 if seed >> k & 1 else 0.9 for k in range(4)], strict=True))
    assert contradictions(sheet(), fitted(**off)) == []
    assert contradictions(sheet(), Model(())) == []


@pytest.mark.parametrize(
    ("name", "unknown"),
    [("tendon_stiffness_N", "sheath_length_mm"), ("friction_coefficient", "total_bend_rad")],
)
def test_what_takes_the_place_of_an_unknown_length_or_bend_is_no_contradiction(name, unknown):
    """The fit shows the stiffness over the length, and the product of friction and bend."""
    assert len(contradictions(sheet(), fitted(**{name: 3.0}))) == 1
    assert contradictions(sheet(**{unknown: None}), fitted(**{name: 3.0})) == []


def test_what_the_recordings_do_not_tell_is_no_contradiction():
    assert contradictions(sheet(), fitted(width=0.9, tendon_stiffness_N=1.5)) == []
    given = Model(tuple(replace(e, origin="given") for e in forces(0.5).estimates))
    assert contradictions(sheet(), given) == []


@pytest.mark.parametrize(("stated", "said"), [(1e-6, 0), (1e-2, 1)])
def test_a_load_softer_than_a_fit_can_end_at_is_no_contradiction(stated, said):
    """A drive alone is a tendon on a spring of nothing."""
    soft = sheet()
    soft = soft.model_copy(
        update={"rig": soft.rig.model_copy(update={"load_stiffness_N_per_mm": stated})}
    )
    found = contradictions(soft, fitted(load_stiffness_N_per_mm=1e-4 / 1.579))
    assert len(found) == said


def test_a_soft_tendon_has_sheath_and_data_sheet_as_rivals():
    (said,) = contradictions(sheet(), fitted(tendon_stiffness_N=0.5), ["sheath_compression"])
    assert "(3.39e+04 for 6.79e+04 N) is 0.5 times that of the data sheet: sheath_comp" in said
    assert "tendon_modulus_GPa, tendon_diameter_mm or sheath_length_mm explains that" in said
    assert "f_out would change preload (25 for 25 N) and load stiffness (1.58 for 1.58 N" in said
    assert said.endswith("Either would be a rival of sheath_compression.")
    alone = fitted(tendon_stiffness_N=0.5).estimates
    alone = Model(tuple(e for e in alone if e.name != "load_stiffness_N_per_mm"))
    (alone,) = contradictions(sheet(preload_N=None), alone)
    assert "or a common factor of f_in and f_out (unit or gain) explains that." in alone
    (hard,) = contradictions(sheet(), fitted(tendon_stiffness_N=1.3), ["channel_delay"])
    assert "sheath_compression" not in hard
    assert "rival" not in hard


def test_a_sheath_that_a_diagnosis_names_counts_with_the_tendon():
    """The tendon is bounded by its data sheet then, and the sheath takes the rest."""
    bounded = forces(0.5, tendon_stiffness_N=0.9)
    ratio = Estimate(SHEATH, 0.8, "1", "fitted", None, 0.1, 0.7, 1.4)
    model = Model((*bounded.estimates, ratio))
    (said,) = contradictions(sheet(), model, ["sheath_compression"])
    assert said.startswith("A common factor of f_in and f_out of 0.5 [")
    assert said.endswith("or the data sheet. Either would be a rival of sheath_compression.")


def test_a_tendon_at_the_bound_of_its_data_sheet_is_told():
    model = fitted(tendon_stiffness_N=1.0 / 0.85)
    at_bound = [replace(e, at_bound=e.name == "tendon_stiffness_N") for e in model.estimates]
    (said,) = contradictions(sheet(), Model(tuple(at_bound)), ["position_sensor_gain"])
    assert "is 1.18 times that of the data sheet, the bound of what is plausible" in said
    assert said.endswith("Either would be a rival of position_sensor_gain.")


def test_a_calibration_tells_the_factor():
    run = prepared(Rig(), seed=1)
    half = replace(
        run,
        measured={n: 0.5 * v if n.endswith("_N") else v for n, v in run.measured.items()},
    )
    said = calibrate_runs(manifest(half), [half]).cannot_tell
    assert said[0].startswith("A common factor of f_in and f_out of 0.5")
    assert not any(
        "common factor" in note for note in calibrate_runs(manifest(run), [run]).cannot_tell
    )
