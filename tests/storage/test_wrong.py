"""What a person is told when an address or its storage is wrong."""

import socket
import sys
import time

import pytest

import tsas_cli as tsas
from tests.refusals import refusal
from tests.storage.conftest import KEY, SECRET, forget, free_port
from tests.storage.wire import HOST
from tests.test_app import loaded_by
from tsas_cli.recordings import storage
from tsas_cli.recordings.storage_failures import TIMEOUT, storage_error


def line_of(address: str) -> str:
    line = refusal(tsas.read, address)
    assert SECRET not in line
    return line


def test_a_bucket_or_dataset_that_is_not_there(bucket):
    none = "s3://no-such-bucket/x"
    assert line_of(none) == f"{none}/dataset.toml: there is no such bucket"
    assert line_of(f"{bucket}/x").startswith(f"{bucket}/x: no dataset.toml here; expected")


def test_no_credentials(bucket, monkeypatch):
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY")
    forget()
    told = line_of(f"{bucket}/x")
    assert told.startswith(f"{bucket}/x/dataset.toml: no credentials found; set them")


def test_nothing_listens_at_the_endpoint(keys, monkeypatch):
    monkeypatch.setattr(storage, "PAUSE_S", 0.05)
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{HOST}:{free_port()}")
    before = time.monotonic()
    assert "s3://a/b/dataset.toml: the storage cannot be reached" in line_of("s3://a/b")
    assert time.monotonic() - before < 40


def test_a_storage_that_stays_silent_is_given_up_in_time(keys, monkeypatch):
    monkeypatch.setenv(TIMEOUT, "0.5")
    monkeypatch.setattr(storage, "PAUSE_S", 0.05)
    with socket.create_server((HOST, 0)) as silent:
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{HOST}:{silent.getsockname()[1]}")
        before = time.monotonic()
        assert "the storage cannot be reached, or breaks off (" in line_of("s3://a/b")
        assert time.monotonic() - before < 20


@pytest.mark.parametrize(
    ("address", "line"),
    [
        (f"s3://{KEY}:{SECRET}@bucket/x", "s3://bucket/x: an address with a key, a password"),
        (f"s3://bucket/x?X-Amz-Signature={SECRET}", "s3://bucket/x: an address with a key"),
        ("http://host/x", "http://host/x: http:// is no known storage; expected a folder"),
        (f"s3://{KEY}:{SECRET}@[x/y", "s3://…: is no address; expected SCHEME://BUCKET/PATH"),
        ("s3://a\u2100b/x", "s3://…: is no address"),
        ("file://[x", "file://…: is no address"),
        ("s3:///x", "s3:///x: names no object in a bucket"),
        ("s3://bucket/a/../../other", "s3://bucket/a/../../other: names no object in a bucket"),
    ],
)
def test_addresses_that_are_none(address, line):
    assert line_of(address).startswith(line)


def test_what_a_library_says_in_two_lines_is_said_and_no_third():
    """As botocore refuses a name of a bucket."""
    said = ValueError(f'Parameter validation failed:\nInvalid bucket name "a b"\n{SECRET}')
    line = storage_error("s3://a b/x", said).line()
    assert 'failed: Invalid bucket name "a b"); check the address, and repeat the call' in line
    assert SECRET not in line


def test_a_package_that_is_not_installed(monkeypatch):
    monkeypatch.setitem(sys.modules, "s3fs", None)
    registry = pytest.importorskip("fsspec.registry")
    monkeypatch.delitem(registry._registry, "s3", raising=False)
    assert line_of("s3://a/b").endswith("need the package s3fs; install tsas[s3]")


def test_a_file_address_is_a_local_folder_and_so_is_an_output(dataset):
    assert tsas.read(dataset.as_uri())["a"].time_s.size == 500
    line = refusal(tsas.check, dataset, out="s3://bucket/x")
    assert "s3://bucket/x: is an address; expected a local folder" in line


def test_the_command_says_it_in_one_line_and_no_secret(refused_here, bucket, tmp_path):
    refused_here("calibrate", f"{bucket}/x", "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert SECRET not in refused_here("check", f"s3://{KEY}:{SECRET}@bucket/x")


def test_local_datasets_need_no_storage(dataset):
    program = f"import tsas_cli as tsas; tsas.check({str(dataset)!r})"
    assert loaded_by(program) & {"s3fs", "gcsfs", "botocore", "aiohttp"} == set()
