"""Python runs this first where its folder is on PYTHONPATH: no call to the network goes out.

Each that is tried is written down, since who tries may swallow the error.
"""

import os
import sys

CALLS = ("connect", "bind", "sendto", "sendmsg", "getaddrinfo", "gethostbyname", "gethostbyaddr")
FORBIDDEN = {f"socket.{call}" for call in CALLS}


def refuse(event: str, arguments: tuple[object, ...]) -> None:
    """Stop at a call to the network; an audit hook sees those of C code too."""
    if event in FORBIDDEN:
        with open(os.environ["NETWORK_CALLS"], "a", encoding="utf-8") as stream:  # noqa: PTH123
            print(event, arguments[1:], file=stream)
        raise ConnectionRefusedError(f"{event} is forbidden here")


sys.addaudithook(refuse)
