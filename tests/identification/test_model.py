"""model.toml: written and read back alike, and every wrong one is one line."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fitted_to import FittedTo
from tsas_cli.identification.model import CORRECTION, Model, _axial_stiffness, data_sheet
from tsas_cli.identification.model_file import (
    model_of,
    read_fitted_to,
    read_model,
    source_of,
    stated_model,
    write_model,
)
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.tendon import Rig

MODEL = Model(
    (
        Estimate("friction_coefficient", 0.13, "1", "fitted", None, 0.01, 0.11, 0.15, True),
        Estimate("load_stiffness_N_per_mm", 1.5, "N/mm", "data sheet"),
        Estimate("tendon_stiffness_N", 6e4, "N", "default"),
        Estimate(CORRECTION, -1.5, "N", "fitted"),
        Estimate("preload_N", 25.0, "N", "fitted", 'a "b" <c>.d', 0.1, 24.8, 25.2),
        Estimate("x_in_zero_mm", -0.3, "mm", "fitted", 'a "b" <c>.d', 0.1, -0.5, -0.1),
        Estimate("free_tendon.proximal_length_mm", 150.0, "mm", "fitted", None, 2.0, 146.0, 154.0),
    )
)


def table(name, value="0.1", unit="1", more=""):
    return f"format = 1\n[{name}]\nvalue = {value}\nunit = '{unit}'\n{more}"


def friction(value="0.1", unit="1", more=""):
    return table("parameters.friction_coefficient", value, unit, more)


def preload(value):
    return table("runs.a.preload_N", value, "N")


def zero(value):
    return table("runs.a.x_in_zero_mm", value, "mm")


def free_length(value):
    return table("effects.free_tendon.proximal_length_mm", value, "mm")


def file_of(folder, text):
    path = folder / "model.toml"
    path.write_text(text, encoding="utf-8")
    return path


def run(run_id="a", **conditions):
    return Run(id=run_id, file="a.parquet", sha256="0" * 64, **conditions)


@pytest.mark.parametrize(
    "ranges",
    [None, FittedTo(ranges={"f_in_N": (-1.5, 80.0)}, words={"load": ("spring", 'a "b"')})],
)
def test_what_is_written_is_read_back(tmp_path, ranges):
    path = tmp_path / "model.toml"
    dataset = {"name": "x", "hashes": {"a/b.parquet": "0"}}
    write_model(path, MODEL, version="1", dataset=dataset, fitted_to=ranges)
    for told in (path, tmp_path):  # the file, or the folder that calibrate has written
        assert set(read_model(told).estimates) == set(MODEL.estimates)
        assert read_fitted_to(told) == ranges


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("ranges.f_in_N = [80.0, 20.0]", "f_in_N begins at 80, above its end 20"),
        ("ranges.f_in_N = [20.0]", "fitted_to.ranges.f_in_N"),
        ("ranges.f_in_N = [0.0, inf]", "should be a finite number"),
        ("words.load = [1]", "should be a valid string"),
        ("span.f_in_N = [0.0, 1.0]", "unknown key fitted_to.span"),
    ],
)
def test_a_range_that_cannot_be_is_one_line(tmp_path, entry, says):
    path = file_of(tmp_path, f"format = 1\n[fitted_to]\n{entry}\n")
    for read in (read_model, read_fitted_to):
        with pytest.raises(InputError) as stopped:
            read(path)
        assert says in stopped.value.line()
        assert "\n" not in stopped.value.line()


def test_a_rig_takes_its_run_s_values_and_the_effects():
    rig = MODEL.rig(run('a "b" <c>.d', preload_N=20.0, total_bend_rad=2.0, sheath_length_mm=500.0))
    assert (rig.preload_N, rig.x_in_zero_mm, rig.friction_coefficient) == (25.0, -0.3, 0.13)
    assert (rig.total_bend_rad, rig.sheath_length_mm) == (2.0, 500.0)
    assert rig.effects.free_tendon == (150.0, 0.0)


def test_the_data_sheet_is_a_model():
    made = prepared(Rig())
    rig = data_sheet(manifest(made, proximal_length_mm=30.0)).rig(made.run)
    assert rig.tendon_stiffness_N == pytest.approx(67858.4, rel=1e-5)
    assert (rig.friction_coefficient, rig.load_stiffness_N_per_mm) == (0.125, 1.579)
    assert rig.effects.free_tendon.proximal_length_mm == 30.0
    assert data_sheet(manifest(made, friction_coefficient=0.0)).rig(made.run)[0] == 0.0


def test_a_data_sheet_may_state_a_second_tendon():
    """A key of the maker's own that a parameter happens to be named like states nothing."""
    made = prepared(Rig())
    pair = manifest(made, antagonist_preload_N=12.0, antagonist_f_in_share=0.0, preload_N=99.0)
    rig = data_sheet(pair).rig(made.run)
    assert rig.effects.antagonist == (12.0, 1.0, 0.0)
    assert data_sheet(manifest(made)).rig(made.run).effects.antagonist == (0.0, 1.0, 1.0)


def test_a_bend_in_degrees_is_refused():
    with pytest.raises(InputError, match="is the bend in radians"):
        MODEL.rig(run(total_bend_rad=180.0))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("kind = 'model'\n", "format is missing"),
        ("format = 2\n", "format: input should be 1, got 2"),
        ("format = 1\nkind = 'dataset'\n", "kind: input should be 'model', got 'dataset'"),
        ("format = \n", "is not TOML"),
        ("format = 1\nparametres = 1\n", "did you mean parameters"),
        (
            table("parameters.frction_coefficient"),
            "unknown parameter frction_coefficient; did you mean friction_coefficient",
        ),
        (table("runs.a.preload"), "unknown parameter preload; did you mean preload_N"),
        (
            table("effects.free_tendon.proximal_mm"),
            "did you mean free_tendon.proximal_length_mm",
        ),
        (free_length(-0.1), "expected 0 to 5000 mm"),
        (free_length(5000.1), "expected 0 to 5000 mm"),
        (friction(unit="N"), "is in 'N'; expected the unit '1'"),
        (friction().replace("unit = '1'", ""), "unit is missing"),
        (friction("nan"), "value: input should be a finite number, got nan"),
        (friction("-0.1"), "is -0.1; expected 0, or 0.0001 to 10"),
        (friction("1e300"), "friction_coefficient is 1e+300; expected 0, or 0.0001 to"),
        (friction("'x'"), "should be a valid number"),
        (friction("true"), "value: true and false are no numbers"),
        (friction(more="stdder = 0.1"), "did you mean stderr"),
        (friction(more="stderr = nan"), "friction_coefficient.stderr: input should be a finite"),
        (friction(more="stderr = inf"), "friction_coefficient.stderr: input should be a finite"),
        (friction(more="stderr = -0.1"), "stderr: expected 0 to 1e+15, got -0.1"),
        (
            friction(more="interval_low = -inf\ninterval_high = 1.0"),
            "should be a finite number, got -inf",
        ),
        (preload("-5"), "is -5 N; expected 0, or 0.001 to 1"),
        (preload("1e300"), "expected 0, or 0.001 to 100000 N"),
        (table("parameters.tendon_stiffness_N", 1, "N"), "is 1 N; expected 10 to 1e+08 N"),
        (zero("1e300"), "x_in_zero_mm is 1e+300 mm; expected -100000 to 100000"),
        (table(f"parameters.{CORRECTION}", "1e300", "N"), "expected -100000 to 100000"),
        (
            zero("1.0") + "[parameters.x_in_zero_mm]\nvalue = 1.0\nunit = 'mm'\n",
            "x_in_zero_mm is given for all runs and for run a; expected one of both; delete",
        ),
    ],
)
def test_a_wrong_model_is_one_line(tmp_path, text, says):
    path = file_of(tmp_path, text)
    with pytest.raises(InputError) as stopped:
        read_model(path)
    assert says in stopped.value.line()
    assert "\n" not in stopped.value.line()
    assert str(path) in stopped.value.line()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"value": -1.0}, "friction_coefficient is -1; expected 0, or 0.0001 to 10"),
        ({"value": math.nan}, "friction_coefficient: value: input should be a finite number"),
        ({"unit": None}, "unit: input should be a valid string"),
        ({"name": "friktion"}, "unknown parameter friktion"),
        ({"name": "bristles.stiffness_N_per_mm", "unit": "N/mm", "value": 0.0}, "expected 0.01 to"),
        ({"name": "backlash.play_mm", "unit": "mm", "run": "b"}, "belongs to run b; expected one"),
        ({"name": CORRECTION, "unit": "N", "run": "b"}, "belongs to run b; expected one"),
        ({"interval_low": 0.1}, "interval_low and interval_high go together"),
        ({"interval_low": 0.3, "interval_high": 0.1}, "interval_low 0.3 is above"),
        ({"interval_low": 0.3, "interval_high": 0.4}, "lies outside of its interval"),
    ],
)
def test_a_model_in_memory_is_checked_like_its_file(wrong, says):
    given = Model((replace(Estimate("friction_coefficient", 0.1, "1", "given"), **wrong),))
    with pytest.raises(InputError) as stopped:
        model_of(given)
    assert says in stopped.value.line()
    assert "the model in memory" in stopped.value.line()


def test_a_duplicate_parameter_is_refused(tmp_path):
    twice = (Estimate("friction_coefficient", v, "1", "given") for v in (0.1, 0.2))
    with pytest.raises(InputError, match="duplicate parameter friction_coefficient"):
        model_of(Model(tuple(twice)))
    content = "{value = 0.1, unit = 'mm'}"
    path = file_of(
        tmp_path,
        f"format = 1\n[parameters]\n'backlash.play_mm' = {content}\n"
        f"[effects.backlash]\nplay_mm = {content}\n",
    )
    with pytest.raises(InputError, match=r"duplicate parameter backlash\.play_mm"):
        read_model(path)


@pytest.mark.parametrize("end", ["lower", "upper"])
def test_estimates_at_their_bounds_can_be_read_again(end):
    """exp(log(1e4)) is 10000.00000000001, which was beyond the bound of 1e4."""
    for quantity in QUANTITIES.values():
        value = quantity.inside(quantity.scaled(getattr(quantity, end)))
        given = Model((Estimate(quantity.name, value, quantity.unit, "fitted"),))
        assert model_of(given).value(quantity.name) == pytest.approx(getattr(quantity, end))


def test_a_missing_model_and_an_empty_folder(tmp_path):
    for path in (tmp_path, tmp_path / "no.toml"):
        with pytest.raises(InputError, match="cannot be read"):
            read_model(path)


def test_a_rig_of_which_nothing_is_told_is_a_usual_one():
    """A metre of sheath, bent by one radian, with 10 N on a spring of 1 N/mm."""
    rig = Model(()).rig(run())
    assert (rig.friction_coefficient, rig.total_bend_rad) == (0.1, 1.0)
    assert (rig.load_stiffness_N_per_mm, rig.preload_N) == (1.0, 10.0)
    assert (rig.tendon_stiffness_N, rig.sheath_length_mm) == (5e4, 1000.0)
    assert (rig.x_in_zero_mm, rig.x_out_zero_mm) == (0.0, 0.0)
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


def sheet_of(**sheet):
    return Manifest(
        format=1, name="t", kind="measured", rig=sheet,
        run=(run("a", preload_N=3.0), run("b"), run("c", preload_N=0.0)),
    )  # fmt: skip


def test_a_data_sheet_says_what_it_holds_and_no_more():
    sheet = data_sheet(sheet_of(friction_coefficient=0.2))
    assert {(e.name, e.run, e.value, e.unit, e.origin) for e in sheet.estimates} == {
        ("friction_coefficient", None, 0.2, "1", "data sheet"),
        ("preload_N", "a", 3.0, "N", "data sheet"),
        ("preload_N", "c", 0.0, "N", "data sheet"),
    }
    given = Model((Estimate("friction_coefficient", 0.3, "1", "given"),))
    both = stated_model(sheet_of(friction_coefficient=0.2), given)
    assert both.value("friction_coefficient") == 0.3
    assert both.value("preload_N", "a") == 3.0
    assert stated_model(sheet_of(friction_coefficient=0.2), None) == sheet


def test_where_a_model_is_from(tmp_path):
    path = tmp_path / "model.toml"
    write_model(path, MODEL, version="1", dataset={})
    assert set(model_of(path).estimates) == set(MODEL.estimates)
    assert model_of(MODEL) == MODEL
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
    ("text", "name", "run", "value"),
    [
        (friction("0.0"), "friction_coefficient", None, 0.0),
        (free_length(0.0), "free_tendon.proximal_length_mm", None, 0.0),
        (free_length(5000.0), "free_tendon.proximal_length_mm", None, 5000.0),
        (zero(-3.0), "x_in_zero_mm", "a", -3.0),
        (preload(0.0), "preload_N", "a", 0.0),
    ],
)
def test_bounds_and_zeros_that_mean_something_are_read(tmp_path, text, name, run, value):
    assert read_model(file_of(tmp_path, text)).value(name, run) == value
