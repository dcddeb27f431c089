import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tsas_cli.recordings.units import conversion
from tsas_cli.support.errors import InputError


@pytest.mark.parametrize(
    ("unit", "to", "one"),  # what one of the unit is, from its definition
    [
        ("ms", "s", 0.001),
        ("min", "s", 60),
        ("in", "mm", 25.4),
        ("inch", "mm", 25.4),
        ("Inches", "mm", 25.4),
        ('"', "mm", 25.4),
        ("µm", "mm", 0.001),
        ("um", "mm", 0.001),
        ("lbf", "N", 4.4482216152605),
        ("lb", "N", 4.4482216152605),
        ("kip", "N", 4448.2216152605),
        ("kg", "N", 9.80665),
        ("Newton", "N", 1),
        ("deg", "rad", math.pi / 180),
        ("°", "rad", math.pi / 180),
        ("rev", "rad", 2 * math.pi),
        ("1/min", "rpm", 1),
        ("U/min", "rpm", 1),
        ("rev/s", "rpm", 60),
        ("rad/s", "rpm", 30 / math.pi),
        ("deg/s", "rpm", 1 / 6),
        ("rad·s⁻¹", "rpm", 30 / math.pi),
        ("Å", "mm", 1e-7),
        ("mm\u00a0", "mm", 1),
        ("MPa mm²", "N", 1),
        ("in.", "mm", 25.4),
    ],
)
def test_lab_spellings_mean_what_people_mean(unit, to, one):
    slope, zero = conversion(unit, to)
    assert slope == pytest.approx(one, rel=1e-12)
    assert zero == 0


@pytest.mark.parametrize(
    ("unit", "celsius_at_100"),
    [("°C", 100), ("C", 100), ("degF", 340 / 9), ("F", 340 / 9), ("K", -173.15)],
)
def test_temperatures_have_their_zero(unit, celsius_at_100):
    slope, zero = conversion(unit, "°C")
    assert slope * 100 + zero == pytest.approx(celsius_at_100)


@pytest.mark.parametrize(
    ("unit", "newton_on_5_mm"),
    [
        ("Nm", 200),
        ("N m", 200),
        ("N·m", 200),
        ("N×m", 200),
        ("N\u00a0m", 200),
        ("Ncm", 2),
        ("mNm", 0.2),
        ("Nmm", 0.2),
        ("in-lb", 4.4482216152605 * 25.4 / 5),
    ],
)
def test_a_torque_becomes_a_force_on_a_pulley(unit, newton_on_5_mm):
    slope, _ = conversion(unit, "N", pulley_radius_mm=5)
    assert slope == pytest.approx(newton_on_5_mm, rel=1e-12)


def test_an_angle_becomes_a_length_on_a_pulley():
    assert conversion("deg", "mm", pulley_radius_mm=10)[0] == pytest.approx(math.pi / 18)
    turn = conversion("counts", "mm", factor=1 / 4096, factor_unit="turn", pulley_radius_mm=5)
    assert turn[0] * 4096 == pytest.approx(10 * math.pi)


def test_a_factor_says_what_counts_and_volts_are():
    assert conversion("V", "N", factor=50, factor_unit="N") == (50, 0)
    assert conversion("counts", "N", factor=2, factor_unit="lbf")[0] == pytest.approx(
        8.896443230521
    )


@pytest.mark.parametrize(
    ("unit", "to", "message"),
    [
        ("mm", "N", "is not convertible to N; expected a force"),
        ("N", "mm", "is not convertible to mm; expected a length"),
        ("Nm", "N", "set pulley_radius_mm to convert a torque"),
        ("deg", "mm", "set pulley_radius_mm to convert an angle"),
        ("counts", "mm", "factor and factor_unit"),
        ("V", "N", "factor and factor_unit"),
        ("lb", "mm", "is not convertible to mm"),
        ("%", "rad", "is not convertible to rad"),
        ("Hz", "rpm", "turn/s or rad/s"),
        ("1/s", "rpm", "turn/s or rad/s"),
        ("quux", "mm", "is unknown"),
        ("", "mm", "is not convertible to mm"),
        ("delta_degC", "°C", "is not convertible to °C"),
        ("m,m", "mm", "is unknown"),
        ("m*" * 60 + "m", "mm", "is unknown"),
        # What would be worked out to more digits than any memory holds:
        ("9**9**9**9", "mm", "is unknown"),
        ("6^6666666666", "mm", "is unknown"),
        ("9⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹", "mm", "is unknown"),
        ("9" + " squared" * 9, "mm", "is unknown"),
        ("px", "mm", "factor and factor_unit"),
        ("au", "mm", "is unknown"),  # of arbitrary units, not astronomical
        ("mil", "rad", "is unknown"),  # 0.001 inch in a workshop, an angle in an army
        # An angle is no number, though pint gives it no dimension:
        ("mm/deg", "mm", "is not convertible to mm"),
        ("mm rad", "mm", "is not convertible to mm"),
        ("deg^2", "rad", "is not convertible to rad"),
        ("1/deg", "rad", "is not convertible to rad"),
        ("rad/deg", "rad", "is not convertible to rad"),
        ("rad^2/s", "rpm", "is not convertible to rpm"),
        ("km^999", "mm", "is unknown"),  # more than a float holds
    ],
)
def test_what_does_not_fit_is_refused_with_what_to_add(unit, to, message):
    with pytest.raises(InputError) as error:
        conversion(unit, to, where="map.toml, columns.a")
    assert message in error.value.line()
    assert error.value.line().startswith("map.toml, columns.a: ")


@pytest.mark.parametrize("where", ["{}m", "m{}", "m{}s"])
@pytest.mark.parametrize(
    "sign", [*"?~$#&!:;<=>@|\\\x00'\"‰¹⁰½√÷−–‐\u200b\ufffd\uf06d╡", "1", "10 ", "m%"]
)
def test_no_character_of_a_unit_is_passed_over(where, sign):
    unit = where.format(sign)
    with pytest.raises(InputError):
        conversion(unit, "mm")
    with pytest.raises(InputError):
        conversion(unit, "s")


def test_an_angle_in_a_factor_is_no_number():
    for per in ("mm/deg", "mm/turn"):
        with pytest.raises(InputError, match="is not convertible to mm"):
            conversion("deg", "mm", factor=0.2, factor_unit=per)
    with pytest.raises(InputError, match="is not convertible to N"):
        conversion("N m/deg", "N", pulley_radius_mm=5)


@pytest.mark.parametrize(("factor", "one"), [(0.0, "0"), (1e308, "inf")])
def test_a_factor_that_leaves_no_numbers_is_refused(factor, one):
    with pytest.raises(InputError, match=f"m.toml: one V is {one} mm"):
        conversion("V", "mm", factor=factor, factor_unit="m", where="m.toml")


def test_a_radius_is_for_angles_and_torques_alone():
    for unit, to in [("mm", "mm"), ("N", "N"), ("rad", "rad"), ("s", "s")]:
        with pytest.raises(InputError):
            conversion(unit, to, pulley_radius_mm=5)


@given(unit=st.text(max_size=12), to=st.sampled_from(["s", "mm", "N", "rpm", "rad", "°C"]))
def test_no_text_is_a_defect(unit, to):
    try:
        assert all(isinstance(number, float) for number in conversion(unit, to))
    except InputError as error:
        assert error.line().isprintable()  # noqa: PT017
