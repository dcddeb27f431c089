"""A storage that drops, stalls, truncates and lies: told in one line, in time, and gone on from."""

import logging
import time

import pyarrow as pa
import pytest

import tsas_cli as tsas
from tests.refusals import refusal
from tests.storage.conftest import forget
from tsas_cli.recordings import parquet_files, storage
from tsas_cli.recordings.storage import location_of
from tsas_cli.recordings.storage_failures import TIMEOUT
from tsas_cli.recordings.writing import write_dataset

FAULTS = ["drop", "stall", "trickle", "truncate", "503 Slow Down", "500 Internal Error"]
RUN = "runs/a.parquet"


@pytest.fixture
def broken(wire, bucket, monkeypatch):
    """The wire before the storage, with short limits; the bucket is there."""
    monkeypatch.setattr(storage, "PAUSE_S", 0.05)
    assert not location_of(f"{bucket}/opened").is_file()  # its libraries take their time
    monkeypatch.setenv(TIMEOUT, "0.5")
    return wire


@pytest.fixture
def two_runs(tmp_path, manifest, columns):
    """Return the folder of a dataset with two runs."""
    folder, (run,) = tmp_path / "two", manifest.run
    folder.mkdir()
    both = (run, run.model_copy(update={"id": "b", "file": "runs/b.parquet"}))
    tables = {name: pa.table(columns) for name in "ab"}
    write_dataset(folder, manifest.model_copy(update={"run": both}), tables)
    return folder


@pytest.mark.parametrize("fault", FAULTS)
def test_what_breaks_off_once_is_asked_again(broken, bucket, dataset, fault, caplog, monkeypatch):
    log = logging.getLogger("tsas")  # which a library that other tests load may have silenced
    monkeypatch.setattr(log, "disabled", False)
    monkeypatch.setattr(log, "propagate", True)
    caplog.set_level(logging.WARNING, logger="tsas")
    broken.faulty(fault, 1, "PUT")
    tsas.upload(dataset, f"{bucket}/bench")
    broken.faulty(fault, 1, RUN)
    assert tsas.read(f"{bucket}/bench")["a"].time_s.size == 500
    broken.faulty(fault, 2, "dataset.toml")
    assert [run.id for run in tsas.read(f"{bucket}/bench").runs] == ["a"]
    said = [r.getMessage() for r in caplog.records if (r.name, r.levelname) == ("tsas", "WARNING")]
    assert said or fault == "drop"  # aiohttp itself asks again
    assert all(line.startswith(f"{bucket}/bench/") for line in said)
    assert all(line.endswith(("; try 2 of 3 in 0.05 s", "; try 3 of 3 in 0.1 s")) for line in said)


@pytest.mark.parametrize("fault", ["drop", "stall", "trickle", "503 Slow Down"])
def test_what_always_breaks_off_is_one_line_in_time(broken, bucket, dataset, fault):
    tsas.upload(dataset, f"{bucket}/bench")
    data = tsas.read(f"{bucket}/bench")
    broken.faulty(fault, 1000, RUN)
    before = time.monotonic()
    line = refusal(lambda: data["a"])
    assert time.monotonic() - before < 40
    assert line.startswith(f"{bucket}/bench/runs/a.parquet: the storage ")
    if fault[0] != "5":
        assert TIMEOUT in line


def test_a_shorter_answer_than_asked_for_is_asked_again(broken, bucket, dataset, monkeypatch):
    tsas.upload(dataset, f"{bucket}/bench")
    whole = f"GET /{location_of(bucket).path}/bench/{RUN}"
    broken.faulty("lie", 2, whole)
    assert tsas.read(f"{bucket}/bench")["a"].time_s.size == 500
    forget()
    parquet_files._CACHE.clear()
    broken.faulty("lie", 1000, whole)
    assert "breaks off" in refusal(lambda: tsas.read(f"{bucket}/bench")["a"])


@pytest.mark.parametrize("of", ["HEAD", "GET", "PUT"])
def test_an_object_that_is_gone_meanwhile_is_one_line(broken, bucket, dataset, of):
    if of != "PUT":
        tsas.upload(dataset, f"{bucket}/bench")
        data = tsas.read(f"{bucket}/bench")
    broken.faulty("404 Not Found", 1000, of)
    with pytest.raises(tsas.InputError, match=r"is not on the storage|file is missing"):
        tsas.upload(dataset, f"{bucket}/bench") if of == "PUT" else data["a"]
    broken.faulty("404 Not Found", 1000, "GET")
    refusal(tsas.check, f"{bucket}/bench")


@pytest.mark.parametrize("fault", ["drop", "stall", "404 Not Found"])
def test_an_interrupted_upload_goes_on_and_never_reads_as_whole(broken, bucket, two_runs, fault):
    broken.faulty(fault, 1000, "runs/b.parquet")
    line = refusal(tsas.upload, two_runs, f"{bucket}/bench")
    if fault == "404 Not Found":  # of the question whether it is there, too
        assert "1 of 2 recordings are there; the next call goes on" in line
    assert "no dataset.toml here" in refusal(tsas.read, f"{bucket}/bench")
    broken.faulty("", 0)
    tsas.upload(two_runs, f"{bucket}/bench")
    broken.reset()
    tsas.upload(two_runs, f"{bucket}/bench", force=True)
    assert [path for verb, path in broken.requests if verb == "PUT"] == [
        f"/{location_of(bucket).path}/bench/dataset.toml"
    ]
    assert [tsas.read(f"{bucket}/bench")[run].time_s.size for run in "ab"] == [500, 500]


@pytest.mark.parametrize("given", ["x", "0", "-1", "nan", "1e9"])
def test_a_limit_that_is_no_time_is_refused(keys, given, monkeypatch):
    monkeypatch.setenv(TIMEOUT, given)
    forget()
    assert refusal(tsas.read, "s3://a/b") == f"{TIMEOUT}: is {given!r}; expected 0.1 to 3600 s"
