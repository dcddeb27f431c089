import asyncio
import gc
import threading

import pytest

import tsas_cli as tsas
from tests.refusals import refusal
from tsas_cli.recordings import storage
from tsas_cli.recordings.storage import location_of
from tsas_cli.recordings.storage_failures import storage_error


def test_the_manifest_comes_last(dataset, bucket, wire):
    sent = ["runs/a.parquet", "dataset.toml"]
    for force in (False, True):
        wire.reset()
        tsas.upload(dataset, f"{bucket}/bench", force=force)
        changes = [(verb, path.split("/bench/")[1]) for verb, path in wire.requests
                   if verb in ("PUT", "DELETE", "POST")]  # fmt: skip
        assert changes == [("PUT", name) for name in (sent[1:] if force else sent)]
    assert "already exists" in refusal(tsas.upload, dataset, f"{bucket}/bench")


def test_what_belongs_to_no_dataset_is_not_replaced(dataset, bucket):
    there = location_of(f"{bucket}/bench")
    (there / "runs/a.parquet").write_bytes(b"of somebody else")
    line = refusal(tsas.upload, dataset, f"{bucket}/bench", force=True)
    assert "was not written by `tsas upload`" in line
    assert (there / "runs/a.parquet").read_bytes() == b"of somebody else"
    assert not (there / "dataset.toml").is_file()


def test_a_replacement_that_was_cut_off_goes_on(dataset, bucket):
    tsas.upload(dataset, f"{bucket}/bench")
    location_of(f"{bucket}/bench/runs/a.parquet").write_bytes(b"of another version")
    assert "the checksum differs" in refusal(lambda: tsas.read(f"{bucket}/bench")["a"])
    tsas.upload(dataset, f"{bucket}/bench", force=True)
    assert tsas.read(f"{bucket}/bench")["a"].time_s.size == 500


def test_a_recording_that_has_changed_is_not_uploaded(dataset, bucket):
    with (dataset / "runs/a.parquet").open("ab") as file:
        file.write(b"more")
    assert "the checksum differs" in refusal(tsas.upload, dataset, f"{bucket}/bench")
    assert storage.files_of("s3").find(bucket) == []


def test_what_is_no_folder_or_no_address_is_refused(dataset, tmp_path):
    assert "is no address" in refusal(tsas.upload, dataset, str(tmp_path / "there"))
    assert "is no local folder" in refusal(tsas.upload, "s3://a/b", "s3://a/c")


@pytest.mark.parametrize("scheme", ["s3", "gs"])
def test_what_a_refused_upload_leaves_behind_prints_no_traceback(scheme, keys, caplog, monkeypatch):
    """Parts that are still on their way when one is refused fail later, with nobody to hear it."""
    pytest.importorskip(storage.PACKAGES[scheme])
    monkeypatch.setenv("STORAGE_EMULATOR_HOST", "http://127.0.0.1:1")
    files = storage.files_of(scheme)
    over = threading.Event()

    async def refused():
        raise PermissionError("of another part")

    async def given_up():
        task = asyncio.ensure_future(refused())
        await asyncio.sleep(0)
        del task
        gc.collect()
        over.set()

    asyncio.run_coroutine_threadsafe(given_up(), files.loop).result(10)
    assert over.wait(10)
    assert [record for record in caplog.records if record.name == "asyncio"] == []
    if scheme == "gs":
        storage.files_of.cache_clear()


def test_a_refusal_of_google_s_is_told_as_one():
    refused = OSError("Forbidden: https://storage.googleapis.com/upload?token=secret")
    told = storage_error(storage.Address("gs", "bucket/x"), refused).line()
    assert "the storage refuses access" in told
    assert "secret" not in told
