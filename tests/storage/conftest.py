"""An S3-compatible server in a process of its own, and a counting wire before it."""

import itertools
import os
import re
import select
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from tsas_cli.recordings import storage

HOST = "127.0.0.1"
KEY, SECRET = "test-key-id", "test-secret-that-nobody-sees"


NUMBERS = itertools.count()


def free_port() -> int:
    with socket.socket() as found:
        found.bind((HOST, 0))
        return found.getsockname()[1]


@pytest.fixture(scope="session")
def server(tmp_path_factory) -> Iterator[int]:
    """Return the port of a server that lasts as long as the tests."""
    pytest.importorskip("moto.server", reason="needs moto[server]")
    pytest.importorskip("s3fs", reason="needs tsas[s3]")
    port = free_port()
    log = tmp_path_factory.mktemp("server") / "log"
    with log.open("w") as out:
        call = [sys.executable, "-m", "moto.server", "-H", HOST, "-p", str(port)]
        process = subprocess.Popen(call, stdout=out, stderr=out)
    try:
        for _ in range(600):
            with socket.socket() as trial:
                if trial.connect_ex((HOST, port)) == 0:
                    break
            assert process.poll() is None, log.read_text()
            time.sleep(0.1)
        yield port
    finally:
        process.terminate()
        process.wait(timeout=120)


class Wire:
    """Hands on every connection to the server; counts requests, and bytes that come back."""

    def __init__(self, target: int) -> None:
        self.target, self.received, self.sent = target, 0, b""
        self.door = socket.create_server((HOST, 0))
        self.port = self.door.getsockname()[1]
        threading.Thread(target=self._listen, daemon=True).start()

    @property
    def requests(self) -> list[tuple[str, str]]:
        """Each request: what it does, and to which object."""
        found = re.findall(rb"(GET|HEAD|PUT|DELETE|POST) (/\S*) HTTP/1\.1\r\n", self.sent)
        return [(verb.decode(), path.decode()) for verb, path in found]

    def reset(self) -> None:
        self.received, self.sent = 0, b""

    def _listen(self) -> None:
        while True:
            try:
                client, _ = self.door.accept()
            except OSError:
                return
            try:
                server = socket.create_connection((HOST, self.target))
            except OSError:
                client.close()
                continue
            threading.Thread(target=self._hand_on, args=(client, server), daemon=True).start()

    def _hand_on(self, client: socket.socket, server: socket.socket) -> None:
        with client, server:
            while True:
                for side in select.select([client, server], [], [])[0]:
                    try:
                        data = side.recv(65536)
                        if not data:
                            return
                        if side is server:
                            self.received += len(data)
                        else:
                            self.sent += data
                        (client if side is server else server).sendall(data)
                    except OSError:
                        return


@pytest.fixture
def wire(server) -> Iterator[Wire]:
    made = Wire(server)
    yield made
    made.door.close()


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
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{HOST}:{wire.port}")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")


@pytest.fixture
def bucket(keys) -> str:
    """Return the address of an empty bucket."""
    name = f"rigs-{next(NUMBERS)}"
    storage.files_of("s3").mkdir(name)
    return f"s3://{name}"
