"""`tsas sweep` as a person calls it."""

import json
import shutil
import signal
import subprocess
import sys
import time

import pyarrow.parquet as pq
import pytest

from tests.commands.documented import documented
from tsas_cli.commands.sweep import _plan
from tsas_cli.support.errors import InputError

CALL = [sys.executable, "-m", "tsas_cli", "sweep"]


@pytest.fixture
def rigs(tmp_path, dataset):
    for name in ("a", "b", "c"):
        shutil.copytree(dataset, tmp_path / "rigs" / name)
    return tmp_path / "rigs"


def test_a_stage_is_called_for_every_dataset_and_failure_is_told(strict, done, rigs, tmp_path):
    (rigs / "b/runs/a.parquet").write_bytes(b"no Parquet")
    out = tmp_path / "out"
    first = strict("sweep", "check", rigs / "*", "--out", out, "--workers", 1)
    said = f"tsas: {out}: 1 task failed, as sweep.json says; repeat the call to run them again\n"
    assert (first.returncode, first.stderr) == (2, said)
    lines = [line.split() for line in first.stdout.splitlines()]
    assert lines[0] == ["check:", "2", "of", "3", "tasks", "done", "→", f"{out}/sweep.parquet"]
    assert ["warnings", "2", "1", "1", "1"] in lines
    assert ["failed", "1"] in lines
    failed = next(line for line in first.stdout.splitlines() if "b/runs/a.parquet" in line)
    assert "the checksum differs from the manifest's" in failed
    assert first.stdout.endswith("run the failed tasks again; the others are kept.\n")

    shutil.copy(rigs / "a/runs/a.parquet", rigs / "b/runs/a.parquet")
    call = ("sweep", "check", rigs / "*", "--out", out, "--workers", 1, "--json")
    summary = json.loads(done(*call))
    assert summary == json.loads((out / "sweep.json").read_text(encoding="utf-8"))
    assert summary["counts"] == {"done": 3, "failed": 0}
    assert set(summary) == documented("sweep.json")
    table = pq.read_table(out / "sweep.parquet")
    assert set(table.column_names) >= {"task", "dataset", "state", "error"}
    task = json.loads((out / "tasks" / summary["tasks"][0]["task"] / "task.json").read_text())
    assert set(task) == documented("task.json")
    line = json.loads((out / "journal.jsonl").read_text().splitlines()[0])
    assert set(line) == documented("journal.jsonl")


def test_ctrl_c_keeps_what_is_done_and_the_next_call_goes_on(rigs, tmp_path, done):
    out = tmp_path / "out"
    plan = tmp_path / "plan.toml"
    plan.write_text(
        'stage = "simulate"\ndatasets = "rigs/a"\n[vary]\n'
        "friction_coefficient = { from = 0.1, to = 0.2, steps = 12 }\n"
    )
    call = [*CALL, str(plan), "--out", str(out), "--workers", "1"]
    process = subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    journal = out / "journal.jsonl"
    end = time.monotonic() + 120.0
    while not journal.exists() or not journal.read_text():
        assert time.monotonic() < end
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    streams = process.communicate(timeout=60.0)
    assert (process.returncode, streams) == (130, (b"", b""))
    before = len(journal.read_text().splitlines())
    kept = [path for path in (out / "tasks").iterdir() if not path.name.startswith(".")]
    assert 1 <= before <= len(kept) < 12
    assert not (out / "sweep.json").exists()
    printed = done("sweep", plan, "--out", out, "--workers", "1")
    assert f"{len(kept)} of them were completed before." in printed
    assert len(journal.read_text().splitlines()) == before + 12 - len(kept)
    assert not [path for path in (out / "tasks").iterdir() if path.name.startswith(".")]


def test_options_are_written_as_in_a_plan_or_as_plain_words():
    assert _plan(
        "simulate", ["a"], ["nodes=30", "dynamics=lugre", 'runs=["x", "y"]', "fit_own=true"],
        each_run=False,
    ) == {
        "stage": "simulate",
        "datasets": ["a"],
        "each_run": False,
        "options": {"nodes": 30, "dynamics": "lugre", "runs": ["x", "y"], "fit_own": True},
    }  # fmt: skip
    with pytest.raises(InputError, match="'nodes' is no option; expected NAME=VALUE"):
        _plan("simulate", ["a"], ["nodes"], each_run=False)
    with pytest.raises(InputError, match="a plan has no further arguments"):
        _plan("plan.toml", ["a"], [], each_run=False)


def test_a_wrong_call_is_one_line_and_writes_nothing(refused, rigs, tmp_path):
    said = refused("sweep", "calibrat", rigs / "*", "--out", tmp_path / "out")
    assert said.startswith("tsas: the plan: stage: input should be 'check', 'calibrate'")
    assert not (tmp_path / "out").exists()
