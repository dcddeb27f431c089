"""Where a recording goes: into a file, or to a viewer while it is made."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rerun as rr

from tsas_cli.errors import InputError
from tsas_cli.files import new_file
from tsas_cli.reporting.stream.recorder.recorder import Recorder

SLOWEST_S = 10.0  # that a viewer may take to read what it is sent


@contextmanager
def to_file(path: Path, name: str, *, force: bool = False) -> Iterator[Recorder]:
    """Record into a file that is there, whole, when the block ends without an error.

    Parameters
    ----------
    path
        The file, usually `….rrd`.
    name
        What the viewer calls the recording; it keeps one layout for each name.
    force
        Replace the file if it is there.

    Raises
    ------
    InputError
        The file is there, or cannot be written; Rerun is switched off.
    """
    with new_file(path, force=force) as temporary, _strict():
        stream = _opened(name)
        stream.save(temporary)
        try:
            yield Recorder(stream)
        finally:
            stream.disconnect()  # writes the footer


@contextmanager
def to_viewer(address: str, name: str) -> Iterator[Recorder]:
    """Record into a viewer that listens at `rerun+http://HOST:PORT/proxy`.

    Raises
    ------
    InputError
        It does not take what it is sent; Rerun is switched off.
    """
    with _strict():
        stream = _opened(name)
        stream.connect_grpc(address)
        try:
            yield Recorder(stream)
            stream.flush(timeout_sec=SLOWEST_S)
        except RuntimeError as error:
            raise InputError(f"no viewer takes the stream ({error})", where=address) from error
        finally:
            stream.disconnect()


def _opened(name: str) -> rr.RecordingStream:
    plain = re.sub(r"[^A-Za-z0-9]+", "-", f"tsas {name}").strip("-")  # all that Rerun takes
    stream = rr.RecordingStream(plain)
    if not rr.is_enabled(stream):
        raise InputError("Rerun is switched off", where="RERUN", remedy="unset this variable")
    stream.send_recording_name(name)
    return stream


@contextmanager
def _strict() -> Iterator[None]:
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    try:
        yield
    finally:
        rr.set_strict_mode(before)
