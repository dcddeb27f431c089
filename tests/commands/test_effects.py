import json

from tsas_cli.effects import EFFECTS


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
    (backlash,) = (effect for effect in content["effects"] if effect["name"] == "backlash")
    assert backlash["acts_on"] == "drive"
    (play,) = backlash["parameters"]
    assert (play["name"], play["unit"], play["neutral"]) == ("play_mm", "mm", 0.0)
    assert (play["lower"], play["upper"]) == (0.0, 20.0)
