"""What is fetched of a recording, and that all of it is checked."""

import json
import math
import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tsas_cli.recordings import storage
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.run_files import open_run
from tsas_cli.recordings.storage import place_of
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.errors import InputError

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
    return folder, place_of(f"{bucket}/bench")


def put(bucket, name, content):
    storage.files_of("s3").pipe_file(f"{bucket}/{name}", content)


def test_one_column_of_six_is_read_without_the_others(large, wire):
    folder, address = large
    size = (folder / "runs/a.parquet").stat().st_size
    here, there = (read_dataset(place).runs[0] for place in large)
    wire.reset()
    column = open_run(address, there).read("f_out_N")
    np.testing.assert_array_equal(column, open_run(folder, here).read("f_out_N"))
    footer = pq.read_metadata(folder / "runs/a.parquet").row_group(0)
    chunk = footer.column(1 + NAMES.index("f_out_N")).total_compressed_size
    # Beside the column: the end of the file, half a block at either side, the list, what HTTP says.
    assert chunk < wire.received < chunk + 130_000 < size / 3
    assert [verb for verb, path in wire.requests if path.endswith(OBJECT)] == ["HEAD", "GET", "GET"]


def test_what_was_read_is_not_fetched_again(large, wire):
    _, address = large
    run = read_dataset(address).runs[0]
    first = open_run(address, run).read("f_out_N")
    wire.reset()
    np.testing.assert_array_equal(open_run(address, run).read("f_out_N"), first)
    assert [verb for verb, path in wire.requests if path.endswith(OBJECT)] == ["HEAD"]


def test_columns_that_tsas_does_not_know_are_not_fetched(tmp_path, manifest, columns, bucket, wire):
    unknown = {"other": np.random.default_rng(7).normal(size=500_000)}
    known = {name: np.linspace(0, 1, 500_000) + values[:1] for name, values in columns.items()}
    folder = tmp_path / "unknown"
    folder.mkdir()
    write_dataset(folder, manifest, {"a": pa.table(known | unknown)})
    tsas.upload(folder, f"{bucket}/bench")
    wire.reset()
    there = tsas.read(f"{bucket}/bench")["a"]
    for name, values in tsas.read(folder)["a"].columns.items():
        np.testing.assert_array_equal(there.columns[name], values)
    assert wire.received < 0.5 * (folder / "runs/a.parquet").stat().st_size


@pytest.mark.parametrize("listed", ["none", "of another file", "no list", "too short", "no end"])
def test_without_a_list_of_use_the_whole_file_is_fetched(large, bucket, wire, listed):
    folder, address = large
    name = f"{OBJECT}.blocks.json"
    told = json.loads(storage.files_of("s3").cat_file(f"{bucket}/{name}"))
    if listed == "none":
        storage.files_of("s3").rm_file(f"{bucket}/{name}")
    elif listed == "no list":
        put(bucket, name, b"[1, 2")
    elif listed == "no end":
        put(bucket, name, json.dumps(told | {"size": math.inf}).encode())
    else:
        other = {"sha256": "0" * 64} if "another" in listed else {"blocks": told["blocks"][:-1]}
        put(bucket, name, json.dumps(told | other).encode())
    wire.reset()
    there, here = (read_dataset(place)["a"].columns for place in (address, folder))
    np.testing.assert_array_equal(there["f_out_N"], here["f_out_N"])
    assert wire.received > (folder / "runs/a.parquet").stat().st_size


@pytest.mark.parametrize("with_list", [True, False])
def test_one_wrong_byte_is_noticed_where_it_is_read(large, bucket, with_list):
    folder, address = large
    content = bytearray((folder / "runs/a.parquet").read_bytes())
    content[len(content) // 2] ^= 1
    put(bucket, OBJECT, bytes(content))
    if not with_list:
        storage.files_of("s3").rm_file(f"{bucket}/{OBJECT}.blocks.json")
    (folder / "runs/a.parquet").write_bytes(content)
    lines = []
    for place in large:
        with pytest.raises(InputError, match="the checksum differs from the manifest's") as caught:
            read_dataset(place)["a"]
        lines.append(caught.value.line().removeprefix(f"{place}/"))
    assert lines[0] == lines[1]
    run = read_dataset(address).runs[0]
    if with_list:
        open_run(address, run).read("time_s")  # what stands elsewhere is as it was
        with pytest.raises(InputError, match="the checksum differs"):
            [open_run(address, run).read(name) for name in NAMES]


def test_another_recording_in_its_place_is_noticed_even_with_its_own_list(large, bucket, tmp_path):
    folder, address = large
    other = tmp_path / "other"
    other.mkdir()
    manifest = read_dataset(folder).manifest
    columns = dict(read_dataset(folder)["a"].columns)
    write_dataset(other, manifest, {"a": pa.table(columns | {"f_in_N": columns["f_in_N"] + 1})})
    was = storage.files_of("s3").cat_file(f"{bucket}/bench/dataset.toml")
    tsas.upload(other, f"{bucket}/bench", force=True)
    put(bucket, "bench/dataset.toml", was)
    with pytest.raises(InputError, match="the checksum differs"):
        read_dataset(address)["a"]


def test_a_recording_that_is_gone_is_told_as_for_a_folder(large, bucket):
    _, address = large
    storage.files_of("s3").rm_file(f"{bucket}/{OBJECT}")
    with pytest.raises(InputError, match="the run's file is missing") as caught:
        read_dataset(address)["a"]
    assert caught.value.where == f"{bucket}/{OBJECT}"


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
    done = subprocess.run(call, capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout == "500 [500]\n"
