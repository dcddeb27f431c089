"""Every number of every file that a person writes has a range, and is refused beyond it."""

from typing import Annotated, get_args, get_origin

import pytest
from pydantic import AfterValidator, BaseModel

import tsas_cli as tsas
from tsas_cli.diagnosis.rig_file import RigFile
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import StoredValue
from tsas_cli.identification.fitted_to import FittedTo
from tsas_cli.recordings.ingest_map import IngestMap
from tsas_cli.recordings.manifest import Manifest, RigSheet
from tsas_cli.support.errors import InputError
from tsas_cli.support.plausible import Range
from tsas_cli.sweeping.plan import SweepPlan
from tsas_cli.tracking.settings import Settings

FILES = (Manifest, IngestMap, RigFile, SweepPlan, Settings, StoredValue, FittedTo)
BY_NAME = "StoredValue.value"  # its name tells the range: QUANTITIES, and RANGES of a drive


def numbers(annotation, place, marks=()):
    """Yield the place and the range, or None, of each number of an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        for name, field in annotation.model_fields.items():
            inner = f"{annotation.__name__}.{field.alias or name}"
            yield from numbers(field.annotation, inner, field.metadata)
    elif get_origin(annotation) is Annotated:
        yield from numbers(annotation.__origin__, place, annotation.__metadata__)
    elif annotation is float:
        functions = [mark.func for mark in marks if isinstance(mark, AfterValidator)]
        yield place, next((f for f in functions if isinstance(f, Range)), None)
    else:
        for inner in get_args(annotation):
            yield from numbers(inner, place)


def test_every_number_of_every_file_has_a_range():
    found = dict(one for file in FILES for one in numbers(file, ""))
    assert len(found) > 60
    assert [place for place, allowed in found.items() if allowed is None] == [BY_NAME]


def test_a_data_sheet_may_state_of_an_effect_what_a_model_may_hold():
    sheet = {place.rpartition(".")[2]: allowed for place, allowed in numbers(RigSheet, "")}
    stated = {
        name: (p.lower, p.upper)
        for effect in EFFECTS
        for p in effect.parameters
        for name in {p.name, f"{effect.name}_{p.name}"} & sheet.keys()
    }
    assert len(stated) == 5
    assert {name: (sheet[name].low, sheet[name].high) for name in stated} == stated


def test_a_range_holds_its_ends_and_says_its_unit_and_what_was_expected():
    allowed = Range(1e-3, 1e6, "mm", or_zero=True)
    assert [allowed(value) for value in (0.0, 1e-3, 1.0, 1e6)] == [0.0, 1e-3, 1.0, 1e6]
    for value in (-1.0, 0.9e-3, 1.1e6, 1e300, -1e300, float("nan")):
        with pytest.raises(ValueError, match=r"^expected 0, or 0.001 to 1e\+06 mm$"):
            allowed(value)


@pytest.mark.parametrize(
    ("table", "key", "value", "said"),
    [
        ("drive", "turntable_radius_mm", 1e300, "expected 0.0001 to 1e+06 mm, got 1e+300"),
        ("drive", "turntable_radius_mm", 1e-300, "expected 0.0001 to 1e+06 mm, got 1e-300"),
        ("loop", "filter_Hz", 1e300, "expected 0.001 to 100000 Hz, got 1e+300"),
        ("sensor", "step_mm", 1e-300, "expected 0, or 1e-09 to 1000 mm, got 1e-300"),
    ],
)
def test_settings_that_overflowed_are_refused_with_their_unit(table, key, value, said):
    with pytest.raises(InputError) as refused:
        tsas.track(settings={table: {key: value}})
    assert refused.value.line() == f"settings: {table}.{key}: {said}"
