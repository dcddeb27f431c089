"""The page of many long runs stays small."""

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.reporting import made_folders
from tests.reporting.pages import pipeline

MOST = 2_000_000  # bytes


@pytest.mark.parametrize("count", [2, pytest.param(10, marks=pytest.mark.large)])
def test_long_runs_of_four_channels_make_less_than_two_megabytes(tmp_path, monkeypatch, count):
    runs = [f"run-{number}" for number in range(count)]
    make = made_folders.columns

    def four(samples, *, seed):
        made = make(samples, seed=seed)
        noise = np.random.default_rng(seed).normal(scale=0.1, size=samples)
        return made | {"x_out_mm": made["x_in_mm"] + noise}

    monkeypatch.setattr(made_folders, "columns", four)
    folders = pipeline(tmp_path, runs, samples=6000)  # more than a plot keeps
    simulate = folders[3]
    with made_folders.edited(simulate / "simulation.json") as content:
        for run, said in content["runs"].items():
            said["channels"]["x_out_mm"] = said["channels"]["f_in_N"] | {"unit": "mm"}
            path = simulate / "runs" / f"{run}.parquet"
            table = pq.read_table(path)
            pq.write_table(table.append_column("x_out_mm", table["f_out_N"]), path)
    text = made_folders.page_from(*folders)
    assert text.count('id="simulation-') > 3 * count
    assert 0.02 * MOST * count < len(text.encode()) < MOST
