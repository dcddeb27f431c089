"""Ports on this machine that nobody else can reach."""

import socket
from contextlib import ExitStack

from tsas_cli.support.errors import InputError

LOOPBACK = "127.0.0.1"
LAST = 65535


def free_ports(count: int, first: int | None = None) -> tuple[int, ...]:
    """Return ports on 127.0.0.1 that nothing listens on: any, or `first` and those after it.

    InputError: one of those asked for is in use, or may not be had.
    """
    wanted = [0] * count if first is None else range(first, first + count)
    with ExitStack() as held:  # all at once, so that no two are the same
        return tuple(held.enter_context(_listening(port)).getsockname()[1] for port in wanted)


def _listening(port: int) -> socket.socket:
    reason = f"the last is {LAST}"
    if port <= LAST:
        try:
            return socket.create_server((LOOPBACK, port))
        except OSError as error:
            reason = str(error.strerror)
    raise InputError(
        f"port {port} cannot be had ({reason})",
        where="--port",
        remedy="choose another one, or leave --port out",
    )
