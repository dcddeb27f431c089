"""What every effect owes its reader: the list is whole, the text and the units are there."""

import math
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import tsas_cli.effects
from tsas_cli.effects import EFFECTS, LAWS, Effects

FOLDER = Path(tsas_cli.effects.__file__).parent
BY_NAME = {effect.name: effect for effect in EFFECTS}
FLOW = ("drive", "tendon", "load", "sensor")
PARTS = ("What one sees", "Equation", "Mistaken for", "Not validated")


def unit_suffix(unit: str) -> str:
    """Return a unit as it stands at the end of a name: "1/mm²" is "_per_mm2"."""
    spelled = unit.replace("²", "2").replace(" ", "_").removeprefix("1/")
    return f"_per_{spelled}" if unit.startswith("1/") else "_" + spelled.replace("/", "_per_")


every_effect = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
SUFFIXES = {p.unit: unit_suffix(p.unit) for e in EFFECTS for p in e.parameters if p.unit != "1"}


def test_every_file_is_in_the_list_in_the_order_of_the_fields():
    files = {path.stem for path in FOLDER.glob("*.py")} - {"__init__", "effect"}
    assert {effect.name for effect in EFFECTS} == files
    assert tuple(effect.name for effect in (*EFFECTS, *LAWS)) == Effects._fields


@every_effect
def test_the_text_is_the_docstring_of_the_file_and_has_its_parts(effect):
    assert effect.doc == import_module(f"tsas_cli.effects.{effect.name}").__doc__
    first, _, rest = effect.doc.partition("\n\n")
    assert first.endswith(".")
    assert effect.sentence == first
    assert "\n" not in first
    places = [rest.find(f"{part}:") for part in PARTS]
    assert -1 not in places
    assert places == sorted(places)
    assert effect.experiment.endswith(".")


@every_effect
def test_the_record_describes_the_values(effect):
    values = getattr(Effects(), effect.name)
    assert tuple(p.name for p in effect.parameters) == values._fields
    assert tuple(p.neutral for p in effect.parameters) == tuple(values)
    for p in effect.parameters:
        assert p.lower <= p.neutral <= p.upper
        assert p.lower < p.start < p.upper
        assert p.shape or p.start != p.neutral
        assert all(p.lower <= value <= p.upper for value in p.starts)
        assert len(set(p.starts)) == len(p.starts)
    assert not all(p.shape for p in effect.parameters)


@every_effect
def test_a_name_ends_with_its_unit_and_with_no_longer_one(effect):
    for p in effect.parameters:
        suffixes = [suffix for suffix in SUFFIXES.values() if p.name.endswith(suffix)]
        assert max(suffixes, key=len, default=None) == SUFFIXES.get(p.unit)


@pytest.mark.parametrize(
    ("unit", "suffix"),
    [
        ("mm", "_mm"),
        ("N/mm", "_N_per_mm"),
        ("mm/N", "_mm_per_N"),
        ("1/s", "_per_s"),
        ("1/mm²", "_per_mm2"),
        ("N s/mm", "_N_s_per_mm"),
    ],
)
def test_how_a_unit_stands_in_a_name(unit, suffix):
    assert unit_suffix(unit) == suffix


@every_effect
def test_the_record_can_be_printed(effect):
    assert effect.acts_on in FLOW
    assert len(effect.title) <= 60
    for line in (effect.title, effect.equation):
        assert line.isprintable()
        assert line.strip() == line != ""
    assert "=" in effect.equation or "→" in effect.equation


def test_the_list_follows_the_force_from_the_drive_to_the_sensors():
    places = [FLOW.index(effect.acts_on) for effect in EFFECTS]
    assert places == sorted(places)
    assert set(places) == set(range(len(FLOW)))


@every_effect
def test_it_is_mistaken_for_effects_that_are_there(effect):
    """What is spelled like an effect is one, and another one."""
    _, _, mistaken = effect.doc.partition("Mistaken for:")
    spelled = set(re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", mistaken.partition("Not validated")[0]))
    channels = {"f_in", "f_out", "x_in", "x_out"}
    assert spelled - channels <= set(Effects._fields) - {effect.name}


def test_every_period_of_a_ripple_is_tried():
    """Sixty, evenly spaced in 1/period from 0.3 to 10 mm, and the one of the paper's gear."""
    period = {p.name: p for p in BY_NAME["drive_ripple"].parameters}["period_mm"]
    assert period.start == pytest.approx(2 * math.pi * 27.1 / (2 * 120), abs=5e-5)
    assert period.start in period.starts
    rest = np.sort(1.0 / np.array([value for value in period.starts if value != period.start]))
    np.testing.assert_allclose(rest, np.linspace(1 / 10.0, 1 / 0.3, 60))
