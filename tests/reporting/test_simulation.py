"""The section of the simulations: each model over the measurement, and which models there are."""

import numpy as np
import pytest

from tests.reporting import made_diagnoses
from tests.reporting import made_folders as by_hand
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.records.diagnosis import EXTENDED_MODEL
from tsas_cli.reporting import simulation
from tsas_cli.reporting.calibration import parameters_section
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.simulation import rms
from tsas_cli.reporting.sources import simulated_models
from tsas_cli.support.files import sha256_of


@pytest.fixture
def diagnosed(dataset, tmp_path):
    folder = made_diagnoses.make_diagnosis(dataset, tmp_path / "diagnose", "named")
    name = "free_tendon.proximal_length_mm"
    length = Estimate(name, 152.0, "mm", "fitted", None, 3.1, 145.9, 158.1)
    fixed = Estimate("x_out_zero_mm", 0.0, "mm", "given", "a")
    write_model(folder / EXTENDED_MODEL, Model((length, fixed)), version="0.1.0", dataset={})
    return made_diagnoses.write_predictions(dataset, folder, made_diagnoses.off_at_the_end)


def test_nominal_and_extended_model_stand_beside_the_simulation(dataset, diagnosed, tmp_path):
    inputs = read_inputs([diagnosed, by_hand.make_simulation(dataset, tmp_path / "smooth")])
    labels = [model.label for model in simulated_models(inputs)]
    assert labels == ["nominal model", "extended model", "smooth"]
    made = simulation.section(inputs)
    table = made.tables[0]
    assert table.header[2:5] == tuple(labels)
    (row,) = (row for row in table.rows if row[:2] == ("b", "f_in_N"))
    sizes, noise, normalised = row[2:5], float(row[5]), row[7:]
    assert float(sizes[0]) > 5.0 * float(sizes[1])
    assert sizes[1] == sizes[2]  # both are the truth
    for size, over in zip(sizes, normalised, strict=True):
        assert float(over) == pytest.approx(float(size) / noise, rel=0.01)
    (picture,) = (p for g in made.groups if g.name == "Run b" for p in g.pictures[:1])
    assert "nominal model" in picture.caption
    assert "smooth" in picture.caption


def test_a_simulation_of_the_extended_model_is_not_shown_twice(dataset, diagnosed, tmp_path):
    folder = by_hand.make_simulation(dataset, tmp_path / "simulate")
    with by_hand.edited(folder / "simulation.json") as content:
        content["model"] = {"file": "m.toml", "sha256": sha256_of(diagnosed / EXTENDED_MODEL)}
    labels = [model.label for model in simulated_models(read_inputs([diagnosed, folder]))]
    assert labels == ["nominal model", "extended model"]


def test_the_parameters_of_the_extended_model_stand_with_interval_unit_and_bound(
    dataset, diagnosed, tmp_path
):
    calibrated = by_hand.make_calibration(dataset, tmp_path / "cal", ["Mind."])
    made = parameters_section(read_inputs([diagnosed, calibrated]))
    captions = [table.caption for table in made.tables]
    assert captions == ["The extended model", "The calibrated model"]
    length = ("free_tendon.proximal_length_mm", "all", "152.0", "145.9 to 158.1", "mm", "fitted")
    assert made.tables[0].rows == ((*length, "no"),)  # x_out was not recorded
    assert made.points == ("Mind.",)


def test_the_rms_leaves_gaps_out():
    assert rms(np.array([3.0, np.nan, -3.0])) == 3.0
    assert np.isnan(rms(np.array([np.nan])))
