"""A Dask scheduler and its workers as separate processes, over TCP on this machine."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
HERE = "127.0.0.1"
CALM = {"OPENBLAS_NUM_THREADS": "1", "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}
START_S = 60.0  # until a process has to be there, on a busy machine


class Cluster:
    """A scheduler, to which workers can be added."""

    def __init__(self, folder, **environment):
        self.folder, self.processes = folder, []
        file = folder / "scheduler.json"
        call = ["scheduler", "--host", HERE, "--port", "0", "--scheduler-file", file]
        self.scheduler = self._start([*call, "--no-dashboard"], environment)
        wait_for(lambda: file.exists() and file.read_text().endswith("}"))
        self.address = json.loads(file.read_text())["address"]

    def add(self, *, threads=1, **environment):
        """Add a worker and wait until the scheduler knows it."""
        call = ["worker", self.address, "--nthreads", threads, "--no-dashboard"]
        call += ["--local-directory", self.folder, "--no-nanny"]
        with self.client() as client:
            before = workers(client)
            worker = self._start(call, CALM | environment)
            wait_for(lambda: workers(client) > before)
        return worker

    def client(self):
        from distributed import Client

        return Client(self.address, set_as_default=False)

    def workers(self):
        with self.client() as client:
            return workers(client)

    def _start(self, call, environment):
        variables = os.environ | {"PYTHONPATH": str(ROOT)} | environment
        with (self.folder / f"{len(self.processes)}.log").open("w") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *map(str, call)],
                env=variables,
                cwd=self.folder,
                stdout=log,
                stderr=log,
            )
        self.processes.append(process)
        return process

    def end(self):
        """End the workers, then the scheduler."""
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def workers(client):
    return len(client.scheduler_info(n_workers=-1)["workers"])


@contextmanager
def cluster(folder, **environment):
    """Yield a scheduler, and end it with its workers."""
    folder.mkdir(exist_ok=True)
    made = Cluster(folder, **environment)
    try:
        yield made
    finally:
        made.end()


def wait_for(what):
    """Wait until something is true."""
    end = time.monotonic() + START_S
    while not what():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.05)
