"""What a model says of a rig where nobody has told it anything, and how two of them go together."""

from pathlib import Path

import pytest

from tests.identification.test_model import MODEL, run
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import (
    CORRECTION,
    Model,
    _axial_stiffness,
    data_sheet,
    model_of,
    read_model,
    source_of,
    stated_model,
    write_model,
)
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.support.errors import InputError


def test_a_rig_of_which_nothing_is_told_is_a_usual_one():
    """A metre of sheath, bent by one radian, with 10 N on a spring of 1 N/mm."""
    rig = Model(()).rig(run())
    assert (rig.friction_coefficient, rig.total_bend_rad) == (0.1, 1.0)
    assert (rig.load_stiffness_N_per_mm, rig.preload_N) == (1.0, 10.0)
    assert (rig.tendon_stiffness_N, rig.sheath_length_mm) == (5e4, 1000.0)
    assert (rig.x_in_zero_mm, rig.x_out_zero_mm) == (0.0, 0.0)


def test_a_straight_sheath_is_straight():
    assert Model(()).rig(run(total_bend_rad=0.0)).total_bend_rad == 0.0


@pytest.mark.parametrize(("friction", "fine"), [(5.0, True), (5.01, False)])
def test_no_tension_gets_through_a_wrap_of_more_than_twenty(friction, fine):
    model = Model((Estimate("friction_coefficient", friction, "1", "given"),))
    if fine:
        assert model.rig(run(total_bend_rad=4.0)).friction_coefficient == friction
    else:
        with pytest.raises(InputError, match=r"a friction_coefficient of 5\.01 over a") as raised:
            model.rig(run(total_bend_rad=4.0))
        assert "total_bend_rad of 4 transmits no tension" in raised.value.line()
        assert "at most 20" in raised.value.line()


def test_a_preload_is_fitted_or_stated_and_corrected_or_usual():
    fitted, stated = run('a "b" <c>.d', preload_N=20.0), run("b", preload_N=20.0)
    assert MODEL.rig(fitted).preload_N == 25.0
    assert MODEL.rig(stated).preload_N == 18.5
    assert MODEL.rig(run("b")).preload_N == 10.0
    assert Model(()).rig(stated).preload_N == 20.0
    corrected = Model((Estimate(CORRECTION, 1.5, "N", "fitted"),))
    assert corrected.rig(run("b", preload_N=0.0)).preload_N == 1.5


def test_a_run_s_own_value_comes_before_the_shared_one():
    both = Model(
        (
            Estimate("preload_N", 1.0, "N", "given"),
            Estimate("preload_N", 2.0, "N", "given", "a"),
        )
    )
    assert [both.value("preload_N", r) for r in ("a", "b", None)] == [2.0, 1.0, 1.0]
    assert [both.estimate("preload_N", r).value for r in ("a", "b", None)] == [2.0, 1.0, 1.0]
    assert both.value("x_in_zero_mm") is None
    with pytest.raises(InputError, match="the model has no preload; did you mean preload_N"):
        both.estimate("preload")
    with pytest.raises(InputError, match="the model has no x_in_zero_mm of run a"):
        both.estimate("x_in_zero_mm", "a")
    assert both.frame()["value"].tolist() == [1.0, 2.0]


def test_over_another_what_is_there_stays_and_what_lacks_is_added():
    first = Model((Estimate("preload_N", 1.0, "N", "given", "a"),))
    second = Model(
        (
            Estimate("preload_N", 3.0, "N", "given", "a"),
            Estimate("preload_N", 4.0, "N", "given", "b"),
        )
    )
    assert [e.value for e in first.over(second).estimates] == [1.0, 4.0]
    assert [e.value for e in second.over(first).estimates] == [3.0, 4.0]


def test_a_tendon_s_stiffness_is_that_of_its_cross_section():
    """1 mm² of 1 GPa are 1 kN; a diameter of 2 mm has π mm²."""
    assert _axial_stiffness(2.0, 1.0) == pytest.approx(3141.592654)
    assert _axial_stiffness(1.2, 60.0) == pytest.approx(60e3 * 3.14159265 * 0.36)
    assert _axial_stiffness(None, 60.0) is None
    assert _axial_stiffness(1.2, None) is None


def manifest(**sheet):
    return Manifest(
        format=1, name="t", kind="measured", rig=sheet,
        run=(run("a", preload_N=3.0), run("b")),
    )  # fmt: skip


def test_a_data_sheet_says_what_it_holds_and_no_more():
    sheet = data_sheet(manifest(friction_coefficient=0.2))
    assert {(e.name, e.run, e.value, e.unit, e.origin) for e in sheet.estimates} == {
        ("friction_coefficient", None, 0.2, "1", "data sheet"),
        ("preload_N", "a", 3.0, "N", "data sheet"),
    }
    given = Model((Estimate("friction_coefficient", 0.3, "1", "given"),))
    both = stated_model(manifest(friction_coefficient=0.2), given)
    assert both.value("friction_coefficient") == 0.3
    assert both.value("preload_N", "a") == 3.0
    assert stated_model(manifest(friction_coefficient=0.2), None) == sheet


def test_where_a_model_is_from(tmp_path):
    path = tmp_path / "model.toml"
    write_model(path, MODEL, version="1", dataset={})
    assert set(model_of(path).estimates) == set(MODEL.estimates)
    assert model_of(MODEL) is MODEL
    assert source_of(None, None) == {"file": "data sheet"}
    assert source_of(None, None, without="nothing") == {"file": "nothing"}
    assert source_of(MODEL, None) == {"file": "in memory"}
    of_file = source_of(path, tmp_path)
    assert Path(of_file["file"]).name == "model.toml"
    assert len(of_file["sha256"]) == 64
    assert source_of(tmp_path, tmp_path) == of_file
    assert "[bristles" not in path.read_text(encoding="utf-8")


def test_bristles_have_a_table_of_their_own(tmp_path):
    path = tmp_path / "model.toml"
    bristles = Model((Estimate("bristles.stiffness_N_per_mm", 4e3, "N/mm", "fitted"),))
    write_model(path, bristles, version="1", dataset={})
    assert "[bristles.stiffness_N_per_mm]" in path.read_text(encoding="utf-8")
    assert read_model(path) == bristles


@pytest.mark.parametrize(
    ("value", "fine"), [(0.0, True), (5000.0, True), (5000.1, False), (-0.1, False)]
)
def test_an_effect_s_value_may_lie_on_its_bounds(tmp_path, value, fine):
    path = tmp_path / "model.toml"
    name = "free_tendon.proximal_length_mm"
    path.write_text(f"format = 1\n[effects.{name}]\nvalue = {value}\nunit = 'mm'\n", "utf-8")
    if fine:
        assert read_model(path).value(name) == value
    else:
        with pytest.raises(InputError, match="expected 0 to 5000 mm"):
            read_model(path)


def test_a_zero_of_a_displacement_may_be_negative(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text("format = 1\n[runs.a.x_in_zero_mm]\nvalue = -3.0\nunit = 'mm'\n", "utf-8")
    assert read_model(path).value("x_in_zero_mm", "a") == -3.0
    path.write_text("format = 1\n[runs.a.preload_N]\nvalue = 0.0\nunit = 'N'\n", "utf-8")
    assert read_model(path).value("preload_N", "a") == 0.0
