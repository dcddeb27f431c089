import json

from tsas_cli.effects import EFFECTS


def test_the_table_has_every_effect_and_every_parameter_once(tsas):
    done = tsas("effects")
    assert (done.returncode, done.stderr) == (0, "")
    rows = [line.split() for line in done.stdout.splitlines()[3:] if line]
    first = [row[0] for row in rows if row[0] in {effect.name for effect in EFFECTS}]
    assert first == [effect.name for effect in EFFECTS]
    assert len(rows) == sum(len(effect.parameters) for effect in EFFECTS)
    lines = iter(done.stdout.splitlines()[3:])
    for effect in EFFECTS:
        for number, p in enumerate(effect.parameters):
            line = next(lines)
            assert f" {p.name}  " in line
            assert p.unit in line
            assert (effect.sentence in line) == (effect.acts_on in line.split()) == (number == 0)


def test_json_holds_the_whole_records(tsas):
    done = tsas("effects", "--json")
    content = json.loads(done.stdout)
    assert content["format"] == 1
    assert [effect["name"] for effect in content["effects"]] == [e.name for e in EFFECTS]
    (backlash,) = (effect for effect in content["effects"] if effect["name"] == "backlash")
    assert backlash["acts_on"] == "drive"
    (play,) = backlash["parameters"]
    assert (play["name"], play["unit"], play["neutral"]) == ("play_mm", "mm", 0.0)
    assert (play["lower"], play["upper"]) == (0.0, 20.0)
