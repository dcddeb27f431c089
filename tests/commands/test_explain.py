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


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("force_sensor_gain", ["f_out_gain", "1", "1", "0.2", "5"]),
        ("preload_loss", ["settling_per_s", "1/s", "any", "0", "0.5"]),  # a shape
    ],
)
def test_parameters_come_with_unit_and_bounds(done, name, row):
    lines = [line.split() for line in done("explain", name).splitlines()]
    assert row in lines
    assert ["parameter", "unit", "neutral", "lowest", "highest"] in lines


@pytest.mark.parametrize(
    ("name", "hint"), [("drive_friktion", "did you mean drive_friction?"), ("?", "channel_delay")]
)
def test_an_unknown_name_is_refused_with_the_nearest(refused, name, hint):
    said = refused("explain", name)
    assert said.startswith(f"tsas: there is no effect '{name}'; ")
    assert hint in said


def test_the_table_has_every_effect_and_every_parameter_once(done):
    lines = [line for line in done("effects").splitlines()[3:] if line]
    shown = [(effect, p) for effect in EFFECTS for p in effect.parameters]
    for line, (effect, p) in zip(lines, shown, strict=True):
        first = p == effect.parameters[0]
        assert f" {p.name}  " in line
        assert p.unit in line
        assert (effect.name == line.split()[0]) == first
        assert (effect.sentence in line) == (effect.acts_on in line.split()) == first


def test_json_holds_the_whole_records(done):
    content = json.loads(done("effects", "--json"))
    assert content["format"] == 1
    assert [effect["name"] for effect in content["effects"]] == [e.name for e in EFFECTS]
    records = {effect["name"]: effect for effect in content["effects"]}
    (play,) = records["backlash"]["parameters"]
    assert (play["name"], play["unit"], play["neutral"]) == ("play_mm", "mm", 0.0)
    assert (play["lower"], play["upper"]) == (0.0, 20.0)
    friction = records["stribeck_friction"]
    assert (records["backlash"]["acts_on"], friction["acts_on"]) == ("drive", "tendon")
    assert "Mistaken for:" in friction["doc"]
    assert [p["shape"] for p in friction["parameters"]] == [False, True, True, True]
    assert friction["parameters"][1]["starts"] == [1.0, 4.0, 15.0]
    one = json.loads(done("explain", "stribeck_friction", "--json"))
    assert one.pop("format") == 1
    assert one.items() >= friction.items()
