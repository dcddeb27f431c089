"""A dozen kills in each run of the tests; `make torture` does hundreds."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.torture.bench import faults_of, make_old, tree

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "stages",
    ["init,ingest,check", pytest.param("init,ingest,check,simulate", marks=pytest.mark.large)],
)
def test_a_dozen_kills_leave_nothing_half_written(tmp_path, stages):
    call = [sys.executable, "-m", "tests.torture", "--kills", "12", "--stages", stages]
    call += ["--out", str(tmp_path / "torture.json")]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    tried = json.loads((tmp_path / "torture.json").read_text())
    ended = sum(one["killed_at_operation"] + one["killed_at_time"] for one in tried)
    assert ended >= 6
    assert {one["stage"] for one in tried} == set(stages.split(","))


@pytest.fixture
def result(tmp_path):
    folder = tmp_path / "result"
    (folder / "runs").mkdir(parents=True)
    for name in ("a.json", "runs/a.parquet"):
        (folder / name).write_text(name)
    return folder


def test_the_judge_sees_what_is_not_whole(result, tmp_path):
    whole = tree(result)
    assert faults_of(result, whole) == []
    make_old(result, tmp_path / "old")
    assert len(faults_of(tmp_path / "old", whole)) == 1
    (result / "more").touch()
    assert [fault.split()[-1] for fault in faults_of(result, whole)] == ["more"]
    (result / "more").unlink()
    (result / "SHA256SUMS").write_text(f"{'0' * 64}  a.json\n")
    assert faults_of(result, tree(result))[0].endswith("a.json does not fit")
    shutil.rmtree(result / "runs")
    assert len(faults_of(result, whole)) == 3
