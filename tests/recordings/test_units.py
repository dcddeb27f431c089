import math

import pytest

from tests.refusals import refusal
from tsas_cli.recordings.guards import Expanded
from tsas_cli.recordings.units import conversion
from tsas_cli.support import limits

PULLEY = {"pulley_radius_mm": 5}


@pytest.mark.parametrize(
    ("units", "to", "one", "said"),  # what one of the units is, from its definition
    [
        (["ms"], "s", 0.001, {}),
        (["min"], "s", 60, {}),
        (["in", "inch", "Inches", '"', "in."], "mm", 25.4, {}),
        (["µm", "um"], "mm", 0.001, {}),
        (["Å"], "mm", 1e-7, {}),
        (["mm\u00a0"], "mm", 1, {}),
        (["lbf", "lb"], "N", 4.4482216152605, {}),
        (["kip"], "N", 4448.2216152605, {}),
        (["kg"], "N", 9.80665, {}),
        (["Newton", "MPa mm²"], "N", 1, {}),
        (["deg", "°"], "rad", math.pi / 180, {}),
        (["rev"], "rad", 2 * math.pi, {}),
        (["1/min", "U/min"], "rpm", 1, {}),
        (["rev/s"], "rpm", 60, {}),
        (["rad/s", "rad·s⁻¹"], "rpm", 30 / math.pi, {}),
        (["deg/s"], "rpm", 1 / 6, {}),
        (["Nm", "N m", "N·m", "N×m", "N\u00a0m"], "N", 200, PULLEY),
        (["Ncm"], "N", 2, PULLEY),
        (["mNm", "Nmm"], "N", 0.2, PULLEY),
        (["in-lb"], "N", 4.4482216152605 * 25.4 / 5, PULLEY),
        (["deg"], "mm", math.pi / 36, PULLEY),
        (["counts"], "mm", math.pi / 36 / 8, PULLEY | {"factor": 1 / 8, "factor_unit": "deg"}),
        (["V"], "N", 50, {"factor": 50, "factor_unit": "N"}),
        (["counts"], "N", 8.896443230521, {"factor": 2, "factor_unit": "lbf"}),
    ],
)
def test_lab_spellings_mean_what_people_mean(units, to, one, said):
    """On a pulley, a torque is a force, and an angle a length; a factor says what volts are."""
    for unit in units:
        assert conversion(unit, to, **said) == (pytest.approx(one, rel=1e-12), 0)


@pytest.mark.parametrize(
    ("unit", "celsius_at_100"),
    [("°C", 100), ("C", 100), ("degF", 340 / 9), ("F", 340 / 9), ("K", -173.15)],
)
def test_temperatures_have_their_zero(unit, celsius_at_100):
    slope, zero = conversion(unit, "°C")
    assert slope * 100 + zero == pytest.approx(celsius_at_100)


@pytest.mark.parametrize(
    ("message", "to", "units"),
    [
        ("is not convertible to N; expected a force", "N", ["mm"]),
        ("is not convertible to mm; expected a length", "mm", ["N"]),
        ("set pulley_radius_mm to convert a torque", "N", ["Nm"]),
        ("set pulley_radius_mm to convert an angle", "mm", ["deg"]),
        ("factor and factor_unit", "mm", ["counts", "px"]),
        ("factor and factor_unit", "N", ["V"]),
        ("turn/s or rad/s", "rpm", ["Hz", "1/s"]),
        ("is not convertible to mm", "mm", ["lb", ""]),
        ("is not convertible to °C", "°C", ["delta_degC"]),
        # An angle is no number, though pint gives it no dimension:
        ("is not convertible to mm", "mm", ["mm/deg", "mm rad"]),
        ("is not convertible to rad", "rad", ["%", "deg^2", "1/deg", "rad/deg"]),
        ("is not convertible to rpm", "rpm", ["rad^2/s"]),
        ("expected deg or gon", "rad", ["grad"]),
        ("is unknown", "mm", ["quux", "m,m", "m*" * 60 + "m"]),
        # What would be worked out to more digits than any memory holds, and more than a float:
        ("is unknown", "mm", ["9**9**9**9", "6^6666666666", "9⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹", "9" + " squared" * 9]),
        ("is unknown", "mm", ["km^999"]),
        ("is unknown", "mm", ["au"]),  # of arbitrary units, not astronomical
        ("is unknown", "rad", ["mil"]),  # 0.001 inch in a workshop, an angle in an army
    ],
)
def test_what_does_not_fit_is_refused_with_what_to_add(message, to, units):
    for unit in units:
        line = refusal(conversion, unit, to, where="map.toml, columns.a")
        assert line.startswith("map.toml, columns.a: ")
        assert message in line


@pytest.mark.parametrize("where", ["{}m", "m{}", "m{}s"])
@pytest.mark.parametrize(
    "sign", [*"?~$#&!:;<=>@|\\\x00'\"‰¹⁰½√÷−–‐\u200b\ufffd\uf06d╡", "1", "10 ", "m%"]
)
def test_no_character_of_a_unit_is_passed_over(where, sign):
    for to in ("mm", "s"):
        refusal(conversion, where.format(sign), to)


def test_an_angle_in_a_factor_is_no_number():
    for per in ("mm/deg", "mm/turn"):
        line = refusal(conversion, "deg", "mm", factor=0.2, factor_unit=per)
        assert "is not convertible to mm" in line
    assert "is not convertible to N" in refusal(conversion, "N m/deg", "N", pulley_radius_mm=5)


@pytest.mark.parametrize(("factor", "one"), [(0.0, "0"), (1e308, "inf")])
def test_a_factor_that_leaves_no_numbers_is_refused(factor, one):
    line = refusal(conversion, "V", "mm", factor=factor, factor_unit="m", where="m.toml")
    assert f"m.toml: one V is {one} mm" in line


def test_a_radius_is_for_angles_and_torques_alone():
    for unit, to in [("mm", "mm"), ("N", "N"), ("rad", "rad"), ("s", "s")]:
        refusal(conversion, unit, to, pulley_radius_mm=5)


def test_what_a_file_expands_to_counts_against_its_size(tmp_path):
    path = tmp_path / "a.mat"
    path.write_bytes(bytes(2_000_000))
    expanded = Expanded.of(path)
    expanded.add(limits.EXPANSION * 2_000_000)
    line = refusal(expanded.add, 1, what="x of (9, 9)")
    assert "x of (9, 9), 1 GB or more from a file of 2 MB; expected at most 500 times" in line
    small = Expanded(path, 10)
    small.add(limits.HARMLESS)
    assert "268 MB or more from a file of 10 bytes" in refusal(small.add, 1)


def test_items_are_counted(tmp_path):
    expanded = Expanded(tmp_path, 80_000)
    for _ in range(10_000):
        expanded.add(0)
    assert "holds more than 10000 variables" in refusal(expanded.add, 0)


def test_what_is_unpacked_has_to_fit_into_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "available", lambda: 1_000_000_000)
    expanded = Expanded(tmp_path / "a.mat", 1)
    expanded.bytes = 1_000_000_000 // limits.COPIES
    expanded.fits()
    expanded.bytes += 1
    assert "needs 1 GB of memory" in refusal(expanded.fits)
