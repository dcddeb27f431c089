"""Which numbers a hypothesis frees, and where it needs a mesh."""

from types import SimpleNamespace

from tsas_cli.effects import EFFECTS
from tsas_cli.identification.extension import Bench, _parameters


def test_an_effect_frees_its_own_parameters_and_nothing_else():
    for effect in EFFECTS:
        assert _parameters([effect.name]) == [f"{effect.name}.{p.name}" for p in effect.parameters]
    both = _parameters(["free_tendon", "backlash"])
    assert {name.split(".")[0] for name in both} == {"free_tendon", "backlash"}
    assert _parameters([]) == []


def test_what_the_closed_form_does_not_hold_for_needs_a_mesh():
    bench = SimpleNamespace(never_closed=False)
    assert not Bench.on_mesh(bench, ["free_tendon", "backlash"])
    assert Bench.on_mesh(bench, ["free_tendon", "presliding"])
    assert Bench.on_mesh(SimpleNamespace(never_closed=True), [])
