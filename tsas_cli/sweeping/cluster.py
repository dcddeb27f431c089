"""Execution on the workers of a running Dask scheduler; only this module imports Dask.

Tasks and outcomes are JSON texts. The workers read the datasets and write the results themselves,
so that they need the same file system under the same paths.
"""

import json
import logging
import os
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.outcome import (
    ONE_THREAD,
    TaskOutcome,
    failure,
    refuse_others,
    run_task,
    versions,
    worker_death,
)

if TYPE_CHECKING:
    from distributed import Client, Security

CONNECT_TIMEOUT_S = 10  # for a scheduler that does not respond
LABEL = "[A-Za-z0-9_-]{1,63}"
ADDRESS = re.compile(
    rf"(?:(?P<how>tcp|tls|ws)://)?(?:{LABEL}(?:\.{LABEL})*\.?|\[[0-9A-Za-z:.%]+\]):(?P<port>[0-9]{{1,5}})"
)
LOGGERS = ("distributed", "distributed.client")  # Dask sets the level of both
START = "{environment} dask worker {address} --nthreads 1 --nworkers auto"


def on_cluster(
    work: str, texts: Sequence[str], address: str, shared: Path
) -> Iterator[tuple[int, TaskOutcome]]:
    """Yield the number and the outcome of each task, in the order of completion.

    The scheduler reassigns the tasks of a worker that dies; after its `allowed-failures` a task has
    failed. If the loop over the outcomes ends early, pending tasks are cancelled. `work` is the
    function to call, `module:function`, `address` what `dask scheduler` prints, `shared` a file
    that every worker has to see, to check the shared file system.

    InputError: dask is not installed, no scheduler responds at the address or it ends, or a worker
    is missing, has other versions, or does not see the file.
    """
    with _connected(address) as client:
        _refuse_workers(client, address, shared)
        futures = client.map(run_task, [work] * len(texts), list(texts), pure=False)
        numbers = {future.key: number for number, future in enumerate(futures)}
        try:
            yield from _outcomes(client, futures, numbers, address)
        finally:
            client.cancel(futures, force=True)


def _connected(address: str) -> "Client":
    """Return a connection to a scheduler, with the log of Dask silenced."""
    try:
        from distributed import Client, Security
    except ModuleNotFoundError as error:
        raise InputError(
            "Dask is not installed", where="--cluster", remedy="pip install 'tsas[dask]'"
        ) from error
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        _refuse_address(address, Security())
        return Client(address, timeout=CONNECT_TIMEOUT_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            "no scheduler responds",
            where=address,
            expected="a running `dask scheduler`",
            remedy="start one, or leave out --cluster",
        ) from error


def _refuse_address(address: str, security: "Security") -> None:
    """Refuse an invalid address, since a client that cannot be created would not close."""
    match = ADDRESS.fullmatch(address)
    if match is None or not 0 < int(match["port"]) < 65536:
        raise InputError(
            f"{address!r} is no scheduler address",
            where="--cluster",
            expected="tcp://HOST:PORT, as `dask scheduler` prints it",
        )
    if match["how"] == "tls" and security.get_connection_args("client")["ssl_context"] is None:
        raise InputError(
            "Dask has no TLS certificates",
            where=address,
            remedy="name them in Dask's settings, under distributed.comm.tls",
        )


def _refuse_workers(client: "Client", address: str, shared: Path) -> None:
    """Refuse workers whose versions, threads or file system differ, before the first task."""
    workers = client.scheduler_info(n_workers=-1)["workers"]
    environment = " ".join(f"{name}={value}" for name, value in ONE_THREAD.items())
    start = START.format(environment=environment, address=shlex.quote(address))
    if not workers:
        raise InputError(
            "the scheduler has no workers", where=address, remedy=f"start some with `{start}`"
        )
    for name, worker in workers.items():
        if worker["nthreads"] != 1:
            raise InputError(
                f"runs {worker['nthreads']} tasks at once in one process",
                where=f"worker {name}",
                expected="one",
                remedy=f"start it with `{start}`",
            )
    try:
        found = json.loads(client.run_on_scheduler(facts, str(shared)))
    except Exception as error:
        raise _no_tsas("the scheduler", error) from error
    refuse_others(versions(), found["versions"], "the scheduler")
    for name, reply in client.run(facts, str(shared), on_error="return").items():
        if isinstance(reply, Exception):
            raise _no_tsas(f"worker {name}", reply) from reply
        _refuse(json.loads(reply), f"worker {name}", shared, start)


def _refuse(found: Mapping[str, Any], where: str, shared: Path, start: str) -> None:
    refuse_others(versions(), found["versions"], where)
    if not found["sees"]:
        raise InputError(
            f"does not see {shared.parent}",
            where=where,
            expected="the same file system under the same path",
            remedy="choose an --out that all workers see",
        )
    if found["threads"] != ONE_THREAD["OPENBLAS_NUM_THREADS"]:
        raise InputError(
            f"OPENBLAS_NUM_THREADS is {found['threads'] or 'not set'}",
            where=where,
            expected="1, for bitwise equal results",
            remedy=f"start it with `{start}`",
        )


def _no_tsas(where: str, error: Exception) -> InputError:
    return InputError(
        f"cannot load tsas ({type(error).__name__}: {error})".splitlines()[0],
        where=where,
        expected="tsas in the same version",
        remedy="install it there",
    )


def facts(shared: str) -> str:
    """Return as JSON the properties that must be equal on all workers; called on each."""
    sees, threads = Path(shared).is_file(), os.environ.get("OPENBLAS_NUM_THREADS", "")
    return json.dumps({"versions": versions(), "threads": threads, "sees": sees})


def _outcomes(
    client: "Client", futures: Sequence[Any], numbers: Mapping[str, int], address: str
) -> Iterator[tuple[int, TaskOutcome]]:
    from distributed import CancelledError, KilledWorker, as_completed

    for future in as_completed(futures, loop=client.loop):
        number = numbers[future.key]
        try:
            yield number, json.loads(future.result())
        except KilledWorker as error:
            yield number, worker_death(error.allowed_failures + 1)
        except CancelledError as error:
            raise InputError(
                "the scheduler has ended",
                where=address,
                remedy="completed tasks are kept; repeat the call to resume",
            ) from error
        except Exception as error:  # noqa: BLE001 # the other tasks continue
            yield number, failure(f"{type(error).__name__}: {error}")
