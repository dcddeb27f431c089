import numpy as np
import pytest

import tsas_cli as tsas
from tests.storage.conftest import free_port
from tests.storage.wire import HOST
from tsas_cli.recordings import storage


@pytest.fixture
def google(monkeypatch):
    """Return the address of a bucket on a server that speaks as Google's storage does."""
    pytest.importorskip("gcsfs", reason="needs tsas[gs]")
    emulator = pytest.importorskip("gcp_storage_emulator.server", reason="needs the emulator")
    port = free_port()
    server = emulator.create_server(HOST, port, in_memory=True, default_bucket="rigs")
    server.start()
    monkeypatch.setenv("STORAGE_EMULATOR_HOST", f"http://{HOST}:{port}")
    yield "gs://rigs"
    files = storage.files_of("gs")
    files.close_session(files.loop, files.session)
    storage.files_of.cache_clear()
    server.stop()


def test_a_dataset_on_google_storage_is_read_as_a_folder_is(dataset, google):
    tsas.upload(dataset, f"{google}/bench")
    here, there = tsas.read(dataset), tsas.read(f"{google}/bench")
    assert there.hashes() == here.hashes()
    for name, values in here["a"].columns.items():
        np.testing.assert_array_equal(there["a"].columns[name], values)
    with pytest.raises(tsas.InputError, match=r"no dataset\.toml here"):
        tsas.read(f"{google}/none")
