"""Where a recording goes: into a file, or to a viewer while it is made."""

import atexit
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from threading import Thread

import rerun as rr
from rerun.blueprint import Blueprint, Container, View
from rerun.chunk import RrdReader

from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_file

PATIENCE_S = 10.0  # in which a file grows, or is whole


@contextmanager
def to_file(path: Path, name: str, layout: Blueprint | None = None) -> Iterator[Recorder]:
    """Record into a file that is there, whole, when the block ends without an error.

    The viewer calls the recording `name`, and opens with `layout` where it is known from the start.

    InputError: the file is there, or cannot be written; Rerun is switched off.
    """
    with new_file(path, mark=b"", inputs=()) as temporary, _strict():
        stream = _opened(name, layout)
        try:
            stream.save(temporary)
        except RuntimeError as error:
            raise _unfinished(path) from error
        recorder = Recorder(stream, path)
        try:
            if layout is not None:
                recorder.lay_out(layout)
            yield recorder
            recorder.settle()
        finally:
            _end(stream, temporary)
        if not is_finished(temporary):
            raise _unfinished(path)


@contextmanager
def to_viewer(address: str, name: str) -> Iterator[Recorder]:
    """Record into a viewer that listens at `rerun+http://HOST:PORT/proxy`.

    InputError: it does not take what it is sent; Rerun is switched off.
    """
    with _strict():
        stream = _opened(name, None)
        stream.connect_grpc(address)
        recorder = Recorder(stream, address)
        try:
            yield recorder
            recorder.settle()
        finally:
            stream.disconnect()


def is_finished(path: Path) -> bool:
    """Return whether a stream was written to its end; what it holds can be shown without, too.

    Only the heads of its parts are read, however large it is. Rerun's own `rerun rrd verify` lets
    empty files pass.

    InputError: it is no stream, holds none, or is cut off within a part.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # says that a stream has no end, which is returned here
            reader = RrdReader(path)
            found = reader.recordings()
    except (RuntimeError, ValueError, OSError) as error:
        reason = str(error).splitlines()[0].removeprefix(f"Failed to read RRD file at {path}: ")
        raise InputError(
            f"cannot be shown ({reason.removeprefix('Failed to decode frame: ')})",
            where=path,
            expected="a whole .rrd file, or the folder of a stage",
        ) from error
    if not found:
        raise InputError("holds no recording", where=path, expected="a stream that tsas wrote")
    try:
        reader.store(store=found[0])
    except RuntimeError:
        return False
    return True


def outline(part: object) -> object:
    """Return what a part of a layout says, without the numbers that Rerun draws for each."""
    if isinstance(part, Container | View):
        return [(name, outline(value)) for name, value in vars(part).items() if name != "id"]
    return [outline(one) for one in part] if isinstance(part, list | tuple) else repr(part)


def _end(stream: rr.RecordingStream, path: Path) -> None:
    """Write the footer; give up where nothing is written any more.

    Rerun's writer ends where the disk is full, and whoever then disconnects may wait for ever. So
    that is left to a thread, and Rerun is not asked to end its streams when the program ends.
    """
    ending = Thread(target=stream.disconnect, daemon=True)
    ending.start()
    size = -1
    while ending.is_alive():
        ending.join(PATIENCE_S)
        before, size = size, path.stat().st_size
        if ending.is_alive() and size == before:
            atexit.unregister(rr.rerun_shutdown)
            return


def _unfinished(path: Path) -> InputError:
    return InputError("cannot be written to its end", where=path, remedy="is the disk full?")


def _opened(name: str, layout: Blueprint | None) -> rr.RecordingStream:
    """Open a recording; a viewer keeps the first layout of an application, hence its own for each.

    The application's name may hold plain letters, digits and hyphens.
    """
    plain = re.sub(r"[^A-Za-z0-9]+", "-", f"tsas {name}").strip("-")
    shown = outline(layout and layout.root_container)
    own = sha256(repr(shown).encode()).hexdigest()[:8]
    stream = rr.RecordingStream(f"{plain}-{own}")
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
