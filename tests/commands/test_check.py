import json

import pytest

import tsas_cli as tsas
from tests.recordings.quality.bench import LOAD, Bench, columns
from tsas_cli.support.files import sha256_of
from tsas_studies.challenge.rig.recordings import Run, write_dataset

GOOD = columns(Bench())
TIME_S = GOOD["time_s"]
BACKWARDS = GOOD | {"time_s": TIME_S - 0.05 * (TIME_S[1000] <= TIME_S)}


@pytest.fixture
def make(tmp_path):
    def make(**runs):
        written = [Run(name, data, {"preload_N": 25.0}) for name, data in runs.items()]
        sheet = {"load_stiffness_N_per_mm": LOAD}
        return write_dataset(tmp_path / "bench", written, data_sheet=sheet)

    return make


def test_findings_are_the_result_and_no_failure(make, done):
    assert "the checks found nothing" in done("check", make(a=GOOD))
    printed = done("check", make(a=GOOD, b=BACKWARDS))
    assert "time-order" in printed
    assert "correct the clock" in printed


def test_json_and_the_written_file_agree(make, done, tmp_path):
    folder = make(a=GOOD, b=BACKWARDS)
    printed = done("check", folder, "--json", "--out", tmp_path / "out")
    written = json.loads((tmp_path / "out" / "check.json").read_text())
    assert json.loads(printed) == written
    assert (written["format"], written["stage"]) == (1, "check")
    assert (tmp_path / "out" / written["dataset"]["folder"]).resolve() == folder.resolve()
    assert written["dataset"]["hashes"]["runs/a.parquet"] == sha256_of(folder / "runs/a.parquet")
    (finding,) = written["findings"]
    assert (finding["code"], finding["run"], finding["column"]) == ("time-order", "b", "time_s")
    reasons = {(entry["code"], entry["run"]) for entry in written["not_checked"]}
    assert ("time-jitter", "b") in reasons
    assert ("time-jitter", "a") not in reasons


def test_one_run_that_cannot_be_read_is_a_finding_and_a_dataset_of_none_is_refused(make, refused):
    folder = make(a=GOOD, b=BACKWARDS)
    (folder / "runs" / "a.parquet").write_bytes(b"")
    findings = tsas.check(folder).findings
    assert [(f.code, f.run) for f in findings] == [("unreadable", "a"), ("time-order", "b")]
    (make(a=GOOD) / "runs" / "a.parquet").write_bytes(b"")
    refused("check", folder)


def reasons_of(report):
    return {entry.code: entry.reason for entry in report.not_checked}


def test_a_channel_that_is_too_short_is_not_said_to_be_missing(make):
    reasons = reasons_of(tsas.check(make(a={n: v[:10] for n, v in GOOD.items()})))
    assert reasons["sign"] == "x_in_mm with fewer than 16 valid samples"
    assert not any("not recorded" in reason for reason in reasons.values())


def test_a_check_whose_columns_are_missing_has_not_passed(make):
    report = tsas.check(make(a={name: GOOD[name] for name in ("time_s", "x_in_mm", "f_in_N")}))
    reasons = reasons_of(report)
    assert list(report.findings) == []
    assert reasons["exchanged"] == "f_out_N not recorded"
    assert reasons["delay"] == "x_out_mm and f_out_N not recorded"
    assert {"unit", "no-steady-motion"} <= reasons.keys()
