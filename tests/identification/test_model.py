"""What a model says of the rig of a run, and a data sheet of a model."""

from datetime import UTC, datetime, timedelta

import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import CORRECTION, Model, _axial_stiffness, data_sheet
from tsas_cli.identification.model_file import (
    stated_model,
)
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.session import Session
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


def run(run_id="a", **conditions):
    return Run(id=run_id, file="a.parquet", sha256="0" * 64, **conditions)


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


@pytest.mark.parametrize(
    ("minutes", "zone", "goes_on"),
    [(0, None, True), (60, None, True), (61, None, False), (-1, None, False), (40, UTC, False)],
)
def test_a_dataset_goes_on_with_a_session_until_that_has_lasted_twice(minutes, zone, goes_on):
    noon = datetime(2026, 5, 4, 12)  # noqa: DTZ001 # the clock of a rig has no zone
    model = Model((), Session(noon, noon + timedelta(minutes=30)))
    began = (noon + timedelta(minutes=minutes)).replace(tzinfo=zone)
    later = Manifest.model_validate(
        {"format": 1, "name": "x", "kind": "measured", "run": [run(started=began)]}
    )
    assert model.session_start(later) == (noon if goes_on else began)
    assert Model(()).session_start(later) == began
    unknown = later.model_copy(update={"run": (run(),)})
    assert model.session_start(unknown) is None


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
