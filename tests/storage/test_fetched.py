"""What is fetched of a recording, and that it is checked."""

import errno
import io
import subprocess
import sys
import tempfile
from hashlib import sha256

import numpy as np
import pyarrow as pa
import pytest

import tsas_cli as tsas
from tests.refusals import refusal
from tsas_cli.recordings import parquet_files, storage
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.run_files import open_run
from tsas_cli.recordings.storage import location_of
from tsas_cli.recordings.writing import write_dataset

ROWS = 60_000
NAMES = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "temperature_C")
OBJECT = "bench/runs/a.parquet"


@pytest.fixture
def large(tmp_path, manifest, bucket, wire):
    """A dataset with one run of six columns of noise, here and at an address."""
    noise = np.random.default_rng(7)
    columns = {"time_s": np.arange(ROWS) / 1000} | {n: noise.normal(size=ROWS) for n in NAMES}
    folder = tmp_path / "large"
    folder.mkdir()
    write_dataset(folder, manifest, {"a": pa.table(columns)})
    tsas.upload(folder, f"{bucket}/bench")
    wire.reset()
    return folder, location_of(f"{bucket}/bench")


class Full(io.BytesIO):
    """A file on a full disk; a buffered one says so only when it is flushed or closed."""

    def __init__(self, buffering=-1):
        super().__init__()
        self.buffered = buffering != 0

    def write(self, part):
        if not self.buffered:
            raise OSError(errno.ENOSPC, "No space left on device")
        return len(part)

    def flush(self):
        if self.buffered:
            raise OSError(errno.ENOSPC, "No space left on device")


class Object:
    """An object of a few bytes that is fetched."""

    def size(self):
        return 7

    def read_part(self, start, end):
        return b"content"[start:end]


def asked(wire, of=OBJECT):
    """Return what was asked of an object."""
    return [verb for verb, path in wire.requests if of in path]


def test_a_recording_is_fetched_once_and_whole(large, wire):
    folder, address = large
    here, there = (open_run(place, read_dataset(place).runs[0]) for place in large)
    for name in NAMES:
        np.testing.assert_array_equal(there.read(name), here.read(name))
    read_dataset(address)["a"]
    assert asked(wire) == ["HEAD", "GET"]
    assert wire.received > (folder / "runs/a.parquet").stat().st_size


def test_of_what_was_fetched_the_latest_is_kept(large, tmp_path, bucket, wire, monkeypatch):
    folder, address = large
    size = (folder / "runs/a.parquet").stat().st_size
    monkeypatch.setattr(parquet_files, "CACHE_BYTES", 1.5 * size)
    tsas.upload(folder, f"{bucket}/other")
    for _ in range(2):
        wire.reset()
        for place in (address, location_of(f"{bucket}/other")):
            read_dataset(place)["a"]
            read_dataset(place)["a"]
        assert asked(wire, "parquet") == 2 * ["HEAD", "GET"]


def test_a_recording_larger_than_one_request_is_whole(large, wire, monkeypatch):
    folder, address = large
    monkeypatch.setattr(parquet_files, "REQUEST_BYTES", 1_000_000)
    there, here = (read_dataset(place)["a"].columns for place in (address, folder))
    np.testing.assert_array_equal(there["f_out_N"], here["f_out_N"])
    size = (folder / "runs/a.parquet").stat().st_size
    assert asked(wire) == ["HEAD", *["GET"] * -(-size // 1_000_000)]
    assert len(asked(wire)) > 3


def test_one_wrong_byte_is_told_as_for_a_folder(large, bucket):
    folder, _ = large
    content = bytearray((folder / "runs/a.parquet").read_bytes())
    content[len(content) // 2] ^= 1
    storage.files_of("s3").pipe_file(f"{bucket}/{OBJECT}", bytes(content))
    (folder / "runs/a.parquet").write_bytes(content)
    lines = [
        refusal(open_run, place, read_dataset(place).runs[0]).removeprefix(f"{place}/")
        for place in large
    ]
    assert "the checksum differs from the manifest's" in lines[0]
    assert lines[0] == lines[1]


def test_where_there_is_no_room_it_is_said(monkeypatch):
    """Of a small recording it was said when the file was flushed: that the output has no room."""
    assert parquet_files._fetch(Object(), sha256(b"content").hexdigest())[:] == b"content"
    monkeypatch.setattr(parquet_files.tempfile, "TemporaryFile", Full)
    with pytest.raises(tsas.InputError, match="cannot be stored while it is read") as caught:
        parquet_files._fetch(Object(), sha256(b"content").hexdigest())
    assert caught.value.where == tempfile.gettempdir()


def test_a_recording_that_is_gone_is_told_as_for_a_folder(large, bucket):
    _, address = large
    storage.files_of("s3").rm_file(f"{bucket}/{OBJECT}")
    line = refusal(lambda: read_dataset(address)["a"])
    assert line.startswith(f"{bucket}/{OBJECT}: the run's file is missing")


def test_a_process_that_was_forked_reads_too(dataset, bucket):
    tsas.upload(dataset, f"{bucket}/bench")
    program = """
import multiprocessing, sys
import tsas_cli as tsas

def rows(address):
    return tsas.read(address)["a"].time_s.size

if __name__ == "__main__":
    with multiprocessing.get_context("fork").Pool(1) as pool:
        pool.map(len, ["before the storage is opened"])
    here = rows(sys.argv[1])
    with multiprocessing.get_context("fork").Pool(1) as pool:
        print(here, pool.map(rows, [sys.argv[1]]))
"""
    call = [sys.executable, "-W", "ignore", "-c", program, f"{bucket}/bench"]
    done = subprocess.run(call, capture_output=True, text=True, check=True, timeout=300)
    assert done.stdout == "500 [500]\n"
