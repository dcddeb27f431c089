"""What the program knows of the paper is the one file that the dataset's folder shows."""

import math
from importlib.resources import files
from pathlib import Path

import pytest

from tsas_cli.paper import Printed, yang2025

SHOWN = Path(__file__).parents[2] / "datasets" / "yang2025" / "values.toml"
PAPER = yang2025()


def test_the_dataset_shows_the_file_that_is_installed():
    assert SHOWN.resolve() == Path(str(files("tsas_cli.paper") / "values.toml")).resolve()


def test_names_lead_to_numbers_with_unit_and_source():
    km = PAPER["stiffness.theory.km_dead_band"]
    assert (km.value, km.unit, km.source) == (175.1, "N/mm", "Table 3")
    assert PAPER.value("groups.d.total_bend") == pytest.approx(math.pi / 2.0)
    assert PAPER.value("rig.tendon_modulus") == 60.0
    assert PAPER.citation["doi"].startswith("10.")


def test_a_value_can_be_changed_without_changing_the_paper():
    other = PAPER.with_value("rig.preload", 30.0)
    assert (other.value("rig.preload"), PAPER.value("rig.preload")) == (30.0, 25.0)
    assert other["rig.preload"].source == PAPER["rig.preload"].source
    with pytest.raises(KeyError):
        PAPER.with_value("rig.prelaod", 30.0)


@pytest.mark.parametrize(
    ("value", "half"),
    [(175.1, 0.05), (2.338, 5e-4), (785.0, 0.5), (4e-4, 5e-5), (1e-8, 5e-9), (-1.96, 5e-3)],
)
def test_half_of_the_last_digit(value, half):
    assert Printed(value, "N", "Table 1").half_a_digit == pytest.approx(half)
