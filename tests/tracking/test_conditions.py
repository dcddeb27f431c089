"""Changes of the plant: what options say, and what they may not."""

import pytest

from tests.tracking.runs import loop_of, settings_of
from tsas_cli.records.tracking import ConditionChange
from tsas_cli.support.errors import InputError
from tsas_cli.tracking.conditions import Condition, disturbed, proximal_spring

PROXIMAL_SPRING = "proximal_spring.stiffness_N_per_mm=12.5"


def plant():
    return loop_of(settings_of())[3]


def test_an_option_is_name_value_and_time():
    assert disturbed(["friction_coefficient=0.16@10", PROXIMAL_SPRING]).changes == (
        ConditionChange(quantity="friction_coefficient", value=0.16, from_s=10.0),
        ConditionChange(quantity="proximal_spring.stiffness_N_per_mm", value=12.5, from_s=0.0),
    )


def test_no_change_is_the_plant_itself():
    assert Condition("undisturbed").of(plant()) == plant()


def test_changes_from_the_start_and_later_ones_are_kept_apart():
    real = disturbed(
        [PROXIMAL_SPRING, "friction_coefficient=0.16@1.5", "total_bend_rad=2.0@1.5"]
    ).of(plant())
    assert real.change_s == 1.5
    assert real.rig.effects.proximal_spring.stiffness_N_per_mm == 12.5
    assert (real.rig.friction_coefficient, real.rig.total_bend_rad) == plant().rig[:5:4]
    assert real.later is not None
    assert (real.later.friction_coefficient, real.later.total_bend_rad) == (0.16, 2.0)
    assert real.later.effects == real.rig.effects
    assert real.actuator == plant().actuator


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ("frictoin_coefficient=0.2", "did you mean friction_coefficient?"),
        ("friction_coefficient", "is no change; expected NAME=VALUE or NAME=VALUE@SECONDS"),
        ("friction_coefficient=much", "is no change"),
        ("friction_coefficient=0.2@soon", "is no change"),
        ("friction_coefficient=-1", "friction_coefficient of -1; expected 0.0001 to 10"),
        ("friction_coefficient=nan", "friction_coefficient of nan"),
        ("friction_coefficient=0.2@nan", "begins at nan s; expected 0 to 1e+06 s"),
        ("friction_coefficient=0.2@inf", "begins at inf s"),
        ("friction_coefficient=0.2@-1", "begins at -1 s"),
        ("friction_coefficient=0.2@1e308", "begins at 1e308 s; expected 0 to 1e+06 s"),
        ("preload_N=20@3", "leave out @3: all displacements count from the preload"),
        ("force_sensor_gain.f_out_gain=1.1@3", "leave out @3: a sensor stays as it is"),
        ("x_in_zero_mm=3", "unknown quantity x_in_zero_mm"),
    ],
)
def test_what_is_no_change_is_refused(option, told):
    with pytest.raises(InputError) as refused:
        disturbed([option])
    assert told in str(refused.value)
    assert str(refused.value).startswith("--disturb: ")


def test_all_later_changes_begin_at_one_time():
    with pytest.raises(InputError, match="changes begin at 1 s, 2 s; expected one time"):
        disturbed(["friction_coefficient=0.16@1", "total_bend_rad=2.0@2"])


def test_two_values_of_one_quantity_at_one_time_are_refused():
    with pytest.raises(InputError, match="friction_coefficient is given twice at 1 s"):
        disturbed(["friction_coefficient=0.16@1", "friction_coefficient=0.2@1"])
    assert len(disturbed(["friction_coefficient=0.16", "friction_coefficient=0.2@1"]).changes) == 2


def test_the_disturbance_of_the_paper_is_a_spring_of_its_stiffness():
    assert proximal_spring() == disturbed([PROXIMAL_SPRING])
