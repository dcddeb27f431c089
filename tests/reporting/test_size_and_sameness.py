"""The page of many long runs stays small, and is the same wherever and whenever it is made."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq

from tests.reporting import made_folders
from tests.reporting.pages import pipeline
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page

MOST = 5_000_000  # bytes
RUNS = [f"run-{number}" for number in range(10)]


def test_ten_long_runs_of_four_channels_make_less_than_five_megabytes(tmp_path, monkeypatch):
    make = made_folders.columns

    def four(samples, *, seed):
        made = make(samples, seed=seed)
        noise = np.random.default_rng(seed).normal(scale=0.1, size=samples)
        return made | {"x_out_mm": made["x_in_mm"] + noise}

    monkeypatch.setattr(made_folders, "columns", four)
    folders = pipeline(tmp_path, RUNS, samples=6000)  # more than a plot keeps
    simulate = folders[3]
    content = json.loads((simulate / "simulation.json").read_text())
    for run, said in content["runs"].items():
        said["channels"]["x_out_mm"] = said["channels"]["f_in_N"] | {"unit": "mm"}
        path = simulate / "runs" / f"{run}.parquet"
        table = pq.read_table(path)
        pq.write_table(table.append_column("x_out_mm", table["f_out_N"]), path)
    (simulate / "simulation.json").write_text(json.dumps(content))
    text = page(read_inputs(folders))
    assert text.count('id="simulation-') > 3 * len(RUNS)
    assert 1_000_000 < len(text.encode()) < MOST


def test_the_page_is_the_same_in_another_folder_time_zone_language_and_hash_seed(tmp_path):
    first, second = tmp_path / "first", tmp_path / "second" / "deeper"
    pipeline(first, ("a",), samples=400)
    shutil.copytree(first, second)
    folders = ["dataset", "check", "calibrate", "simulate", "diagnose"]
    call = [sys.executable, "-m", "tsas_cli", "report", *folders, "--out", "page.html", "--quiet"]
    elsewhere = {"TZ": "Asia/Kolkata", "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
    for place, more, seed in ((first, {"TZ": "UTC", "LC_ALL": "C"}, "1"), (second, elsewhere, "2")):
        environment = os.environ | more | {"PYTHONHASHSEED": seed}
        subprocess.run(call, cwd=place, env=environment, check=True)
    pages = [(place / "page.html").read_bytes() for place in (first, second)]
    assert pages[0] == pages[1]
    assert str(tmp_path).encode() not in pages[0]
