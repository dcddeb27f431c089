from dataclasses import replace

import numpy as np
import pytest

from tests.reporting.made_folders import NOISE, make_simulation
from tsas_cli.numerics.noise import noise_of
from tsas_cli.reporting.inputs import read_inputs


def test_simulations_are_named_by_their_folders_by_their_paths_where_two_share_one(
    dataset, tmp_path
):
    places = [tmp_path / "a" / "simulate", tmp_path / "b" / "simulate", tmp_path / "rough"]
    folders = [make_simulation(dataset, place) for place in places]
    inputs = read_inputs(folders, several=True)
    assert list(inputs.simulations) == [str(places[0]), str(places[1]), "rough"]
    assert [folder for _, folder in inputs.simulations.values()] == places


def test_a_channel_has_one_noise_level_over_all_runs(dataset):
    inputs = read_inputs([dataset])
    levels = [noise_of(recording.get("f_in_N")).sd for recording in inputs.recordings]
    assert inputs.noise["f_in_N"] == pytest.approx(np.sqrt(np.mean(np.square(levels))))
    assert inputs.noise["f_in_N"] == pytest.approx(NOISE, rel=0.05)
    assert "x_out_mm" not in inputs.noise


def test_samples_between_recorded_ones_make_no_channel_less_noisy(dataset):
    inputs, resampled = read_inputs([dataset]), []
    for recording in inputs.recordings:
        rows, f_in = np.arange(recording.time_s.size), recording.columns["f_in_N"]
        columns = {**recording.columns, "f_in_N": np.interp(rows, rows[::5], f_in[::5])}
        resampled.append(replace(recording, columns=columns))
    inputs = replace(inputs, dataset=tuple(resampled))
    assert inputs.noise["f_in_N"] == pytest.approx(NOISE, rel=0.15)


def test_a_parameter_concerns_the_page_unless_its_channel_was_not_recorded(dataset):
    there = ("channel_delay.f_in_delay_s", "f_out_offset_N", "x_in_zero_mm", "preload_N")
    missing = ("channel_delay.x_out_delay_s", "x_out_zero_mm")
    inputs = read_inputs([dataset])
    assert [name for name in there + missing if inputs.concerns(name)] == list(there)
