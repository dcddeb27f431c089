"""An S3-compatible server and a wire before it."""

import itertools
import os
import socket
from collections.abc import Iterator

import pytest

from tests.storage.wire import HOST, Wire
from tsas_cli.recordings import storage

KEY, SECRET = "test-key-id", "test-secret-that-nobody-sees"
NUMBERS = itertools.count()


def free_port() -> int:
    with socket.socket() as found:
        found.bind((HOST, 0))
        return found.getsockname()[1]


@pytest.fixture(scope="session")
def server() -> Iterator[int]:
    """Return the port of a server that lasts as long as the tests."""
    moto = pytest.importorskip("moto.server", reason="needs moto[server]")
    pytest.importorskip("s3fs", reason="needs tsas[s3]")
    running = moto.ThreadedMotoServer(HOST, port=0, verbose=False)
    running.start()
    yield running.get_host_and_port()[1]
    running.stop()


@pytest.fixture
def wire(server) -> Iterator[Wire]:
    made = Wire(server)
    yield made
    made.shutdown()
    made.server_close()


def forget() -> None:
    """Close what has been opened with the settings so far."""
    if storage.files_of.cache_info().currsize:  # Google's tests close their own
        files = storage.files_of("s3")
        files.close_session(files.loop, files.s3)
    storage.files_of.cache_clear()


@pytest.fixture(autouse=True)
def environment(monkeypatch, tmp_path) -> Iterator[None]:
    """Forget the machine's own settings of storages, and what was opened with them."""
    for name in [name for name in os.environ if name.startswith(("AWS_", "FSSPEC_", "GOOGLE_"))]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_CONFIG_FILE", str(tmp_path / "none"))
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "none"))
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    forget()  # what other tests of this process have opened
    yield
    forget()


@pytest.fixture
def keys(monkeypatch, wire) -> None:
    """Let the storage be that of the server, by the settings that its own tools take."""
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", KEY)
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", SECRET)
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{HOST}:{wire.server_port}")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")


@pytest.fixture
def bucket(keys) -> str:
    """Return the address of an empty bucket."""
    name = f"rigs-{next(NUMBERS)}"
    storage.files_of("s3").mkdir(name)
    return f"s3://{name}"
