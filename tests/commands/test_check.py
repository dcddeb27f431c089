import json

import pyarrow as pa
import pytest

from tests.recordings.quality.bench import LOAD, Bench, columns
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality import check_dataset
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.files import sha256_of


@pytest.fixture
def make(tmp_path):
    def make(**runs):
        folder = tmp_path / "bench"
        folder.mkdir()
        entries = [
            {"id": run, "file": f"runs/{run}.parquet", "sha256": "0" * 64, "preload_N": 25.0}
            for run in runs
        ]
        manifest = Manifest.model_validate(
            {
                "format": 1,
                "name": "bench",
                "kind": "simulated",
                "rig": {"load_stiffness_N_per_mm": LOAD},
                "run": entries,
            }
        )
        write_dataset(folder, manifest, {run: pa.table(data) for run, data in runs.items()})
        return folder

    return make


def good(**changes):
    return columns(Bench()) | changes


def backwards():
    time = columns(Bench())["time_s"].copy()
    time[1000:] -= 0.05
    return good(time_s=time)


def test_a_good_dataset_has_no_findings(make, tsas):
    done = tsas("check", make(a=good()))
    assert (done.returncode, done.stderr) == (0, "")
    assert "the checks found nothing" in done.stdout


def test_findings_are_the_result_and_no_failure(make, tsas):
    done = tsas("check", make(a=good(), b=backwards()))
    assert (done.returncode, done.stderr) == (0, "")
    assert "time-order" in done.stdout
    assert "correct the clock" in done.stdout


def test_json_and_the_written_file_agree(make, tsas, tmp_path):
    folder = make(a=good(), b=backwards())
    done = tsas("check", folder, "--json", "--out", tmp_path / "out")
    written = json.loads((tmp_path / "out" / "check.json").read_text())
    assert json.loads(done.stdout) == written
    assert (written["format"], written["stage"]) == (1, "check")
    assert (tmp_path / "out" / written["dataset"]["folder"]).resolve() == folder.resolve()
    assert written["dataset"]["hashes"]["runs/a.parquet"] == sha256_of(folder / "runs/a.parquet")
    (finding,) = written["findings"]
    assert (finding["code"], finding["run"], finding["column"]) == ("time-order", "b", "time_s")
    reasons = {(entry["code"], entry["run"]) for entry in written["not_checked"]}
    assert ("time-jitter", "b") in reasons
    assert ("time-jitter", "a") not in reasons


def test_what_is_no_dataset_is_refused_in_one_line(tsas, tmp_path):
    done = tsas("check", tmp_path, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "dataset.toml" in done.stderr
    assert not (tmp_path / "out").exists()


def test_one_run_that_cannot_be_read_is_a_finding_and_the_others_are_checked(make):
    folder = make(a=good(), b=backwards())
    (folder / "runs" / "a.parquet").write_bytes(b"")
    findings = check_dataset(read_dataset(folder)).findings
    assert [(f.code, f.run) for f in findings] == [("unreadable", "a"), ("time-order", "b")]


def test_a_dataset_of_which_no_run_can_be_read_is_refused(make, tsas):
    folder = make(a=good())
    (folder / "runs" / "a.parquet").write_bytes(b"")
    done = tsas("check", folder)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1


def test_a_check_whose_columns_are_missing_has_not_passed(make):
    drive = {name: good()[name] for name in ("time_s", "x_in_mm", "f_in_N")}
    report = check_dataset(read_dataset(make(a=drive)))
    reasons = {entry.code: entry.reason for entry in report.not_checked}
    assert report.findings == ()
    assert reasons["exchanged"] == "f_out_N not recorded"
    assert reasons["delay"] == "x_out_mm and f_out_N not recorded"
    assert {"unit", "no-steady-motion"} <= reasons.keys()
