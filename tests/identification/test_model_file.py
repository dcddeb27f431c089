"""model.toml: written and read back alike, and every wrong one is one line."""

import math
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import pytest

from tests.identification.test_model import MODEL
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fitted_to import FittedTo
from tsas_cli.identification.model import CORRECTION, Model
from tsas_cli.identification.model_file import (
    model_of,
    read_fitted_to,
    read_model,
    read_source,
    source_of,
    write_model,
)
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.session import Session
from tsas_cli.support.errors import InputError

NOON = "2026-05-04T12:00:00"
SESSION = Session(datetime(2026, 5, 4, 12), datetime(2026, 5, 4, 12, 30))  # noqa: DTZ001


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


@pytest.mark.parametrize(
    "ranges",
    [None, FittedTo(ranges={"f_in_N": (-1.5, 80.0)}, words={"load": ("spring", 'a "b"')})],
)
def test_what_is_written_is_read_back(tmp_path, ranges):
    path = tmp_path / "model.toml"
    dataset = {"name": "x", "hashes": {"a/b.parquet": "0"}}
    model = replace(MODEL, session=SESSION)
    write_model(path, model, version="1", dataset=dataset, fitted_to=ranges)
    for told in (path, tmp_path):  # the file, or the folder that calibrate has written
        assert set(read_model(told).estimates) == set(MODEL.estimates)
        assert read_model(told).session == SESSION
        assert read_fitted_to(told) == ranges


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("ranges.f_in_N = [80.0, 20.0]", "f_in_N begins at 80, above its end 20"),
        ("ranges.f_in_N = [20.0]", "fitted_to.ranges.f_in_N"),
        ("ranges.f_in_N = [2.0, 3.0, 4.0]", "f_in_N: at most 2 items are expected, got 3"),
        ("ranges.f_in_N = [0.0, inf]", "should be a finite number"),
        ("words.load = [1]", "should be text"),
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


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("kind = 'model'\n", "format is missing"),
        ("format = 2\n", "format: input should be 1, got 2"),
        (f"format = 1\nsession = [{NOON}, 2026-05-04T11:59:59]\n", "session ends before it begins"),
        (f"format = 1\nsession = [{NOON}, {NOON}Z]\n", "or one of both has a time zone"),
        (f"format = 1\nsession = [{NOON}]\n", "session"),
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
        (friction("'x'"), "should be a number"),
        (friction("true"), "value: true and false are no numbers"),
        (friction(more="stdder = 0.1"), "did you mean stderr"),
        (friction(more="at_bound = 'no'"), "at_bound: input should be true or false, got 'no'"),
        ("format = 1\n[effects.backlash]\n", "effects.backlash has no parameter"),
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
        ({"unit": None}, "unit: input should be text"),
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
    with pytest.raises(InputError, match="cannot be read"):
        read_model(tmp_path / "no.toml")
    with pytest.raises(
        InputError, match=r"holds no model\.toml; give a model file, or a folder that"
    ):
        read_model(tmp_path)
    (tmp_path / "model-extended.toml").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"name one of its models: model-extended\.toml"):
        read_model(tmp_path)


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


def test_a_wrong_source_is_said_with_its_table(tmp_path):
    written = "format = 1\n[dataset]\nname = 'a'\nfolder = 3\n[dataset.hashes]\n"
    with pytest.raises(InputError, match=r"dataset\.folder: input should be text, got 3"):
        read_source(file_of(tmp_path, written))
    assert read_source(file_of(tmp_path, "format = 1\n")) is None


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
