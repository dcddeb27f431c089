"""The stream to show: one that is there, or one made for this look alone."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tsas_cli.recordings.storage import Location
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import STREAM_FILE, write_stream
from tsas_cli.reporting.stream.opened import is_finished
from tsas_cli.support.errors import InputError


@contextmanager
def stream_of(
    paths: Sequence[Location], step: Callable[[], None] = lambda: None
) -> Iterator[tuple[Path, list[str]]]:
    """Yield the stream's file, and sentences about it; what is made here is gone afterwards.

    A folder that holds a stream shows that; several folders make one of their own, and `step` is
    called after each run.

    InputError: a path is missing, no stream and no folder of a stage, or a file stands among
    others.
    """
    local = [path for path in paths if isinstance(path, Path)]
    for path in local:
        if not path.exists():
            raise InputError("is not there", where=path, expected="an .rrd file or a folder")
    first, *others = paths
    if isinstance(first, Path) and not others:
        stream = first / STREAM_FILE if first.is_dir() else first
        if stream.is_file():
            yield stream, _notes(stream)
            return
    for path in local:
        if not path.is_dir():
            raise InputError(
                "is a file among others",
                where=path,
                expected="folders of stages, or one .rrd file alone",
            )
    with tempfile.TemporaryDirectory(prefix="tsas-view-") as folder:
        stream = Path(folder) / STREAM_FILE
        write_stream(read_inputs(paths), stream, step=step)
        yield stream, []


def _notes(stream: Path) -> list[str]:
    if is_finished(stream):
        return []
    return [f"{stream} has no end: its writer was stopped, or it is cut off; all it holds is shown"]
