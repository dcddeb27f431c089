import json

import pytest

from tsas_cli.effects import EFFECTS, LAWS


@pytest.mark.parametrize("effect", [*EFFECTS[::7], *LAWS], ids=lambda effect: effect.name)
def test_it_prints_all_that_a_person_needs(done, effect):
    wanted = [effect.title, effect.name, effect.equation, effect.doc.strip(), effect.experiment]
    printed = " ".join(done("explain", effect.name).split())
    places = [printed.find(" ".join(part.split())) for part in wanted]
    assert -1 not in places
    assert places == sorted(places)


def test_parameters_come_with_unit_and_bounds(done):
    lines = done("explain", "force_sensor_gain").splitlines()
    assert ["f_out_gain", "1", "1", "0.01", "100"] in [line.split() for line in lines]
    header = next(line for line in lines if "neutral" in line)
    assert header.split() == ["parameter", "unit", "neutral", "lowest", "highest"]


def test_a_shape_is_neutral_at_any_value(done):
    lines = done("explain", "preload_loss").splitlines()
    assert ["settling_per_s", "1/s", "any", "0", "0.5"] in [line.split() for line in lines]


def test_json_is_the_record(done):
    content = json.loads(done("explain", "stribeck_friction", "--json"))
    assert content["format"] == 1
    assert content["name"] == "stribeck_friction"
    assert content["acts_on"] == "tendon"
    assert "Mistaken for:" in content["doc"]
    excess, velocity = content["parameters"]
    assert (excess["shape"], velocity["shape"]) == (False, True)
    assert velocity["starts"] == [1.0, 4.0, 15.0]


@pytest.mark.parametrize(
    ("name", "hint"), [("drive_friktion", "did you mean drive_friction?"), ("?", "channel_delay")]
)
def test_an_unknown_name_is_refused_with_the_nearest(refused, name, hint):
    said = refused("explain", name)
    assert said.startswith(f"tsas: there is no effect '{name}'; ")
    assert hint in said
