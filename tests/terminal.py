"""What programs say at a terminal."""

import os


def read_from(terminal: int) -> str:
    """Return all that is said at a terminal, until no program has it open; and close it."""
    said = b""
    try:
        while part := os.read(terminal, 65536):
            said += part
    except OSError:  # the other end is closed
        pass
    os.close(terminal)
    return said.decode()
