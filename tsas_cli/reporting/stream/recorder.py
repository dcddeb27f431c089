"""What is recorded: components of entities that hold at all times, or that are others at each.

An entity is named by its path, in which names from files are escaped: `rr.new_entity_path`. Rerun
is strict here: columns of different lengths raise `ValueError`, else they would only be dropped. A
recording goes into a file, or to a viewer while it is made.
"""

import atexit
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from threading import Thread

import numpy as np
import numpy.typing as npt
import rerun as rr
from rerun.blueprint import Blueprint, Container, View
from rerun.chunk import RrdReader

from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_file

PATIENCE_S = 10.0  # in which a file grows, or is whole
T, SESSION = "t", "session"  # time within the run, and time of day
SLOWEST_S = 10.0  # that a viewer or a disk may take for what it was sent
ROWS = 8192  # of a series that are sent at a time
_EXTREMES = rr.components.AggregationPolicy.MinMax  # the usual average flattens what is fast


@dataclass(frozen=True)
class Times:
    """Moments of one run on the fixed timelines, to the nanosecond, shape (n,) each."""

    within: npt.NDArray[np.timedelta64]
    of_day: npt.NDArray[np.datetime64] | None = None

    @property
    def columns(self) -> list[rr.TimeColumn]:
        """The moments as Rerun takes them."""
        columns = [rr.TimeColumn(T, duration=self.within)]
        if self.of_day is not None:
            columns.append(rr.TimeColumn(SESSION, timestamp=self.of_day))
        return columns

    def at(self, indices: npt.NDArray[np.int64] | slice) -> "Times":
        """Return some of the moments."""
        of_day = None if self.of_day is None else self.of_day[indices]
        return Times(self.within[indices], of_day)


def times_of(time_s: Floats, started: datetime | None = None) -> Times:
    """Return moments by their time in the run [s], shape (n,), rounded to the nanosecond.

    A start without a time zone is taken as it stands, so that the viewer shows what the manifest
    says; None where it is not known.
    """
    within = np.round(np.asarray(time_s, dtype=np.float64) * 1e9).astype("timedelta64[ns]")
    if started is None:
        return Times(within)
    if started.tzinfo is not None:
        started = started.astimezone(UTC).replace(tzinfo=None)
    return Times(within, np.datetime64(started, "ns") + within)


@dataclass(frozen=True)
class Recorder:
    """Writes entities to one stream, which `to_file` or `to_viewer` opens."""

    stream: rr.RecordingStream
    where: object = ""

    def lay_out(self, layout: Blueprint) -> None:
        """Say what the viewer opens with; the last one counts."""
        self.stream.send_blueprint(layout)

    def settle(self) -> None:
        """Wait until what was recorded is written: what waits for it is kept in memory.

        InputError: the file or the viewer does not take it.
        """
        try:
            self.stream.flush(timeout_sec=SLOWEST_S)
        except RuntimeError as error:
            raise InputError(
                f"does not take the stream ({error})",
                where=self.where,
                remedy="is the disk full, or the viewer gone?",
            ) from error

    def static(self, entity: str, look: rr.AsComponents) -> None:
        """Set components that hold at all times."""
        self.stream.log(entity, look, static=True, strict=True)

    def columns(self, entity: str, times: Times, columns: rr.ComponentColumnList) -> None:
        """Add components that are others at each time."""
        self.stream.send_columns(entity, times.columns, columns, strict=True)

    def series(
        self,
        entity: str,
        times: Times,
        values: Floats,
        name: str,
        colour: int,
        *,
        width: float = 1.5,
    ) -> None:
        """Add all samples of a series, shape (n,), NaN for gaps, which stay gaps.

        The legend calls it `name`; `colour` is 0xRRGGBBAA.
        """
        if values.shape != times.within.shape:
            raise ValueError(f"{values.shape} values at {times.within.size} times")
        look = rr.SeriesLines(names=name, colors=colour, widths=width, aggregation_policy=_EXTREMES)
        self.static(entity, look)
        for first in range(0, values.size, ROWS):
            at = slice(first, first + ROWS)
            known = ~np.isnan(values[at])
            columns = rr.Scalars.columns(scalars=values[at][known])
            if not known.all():
                columns = columns.partition(known.astype(np.int64))
            self.columns(entity, times.at(at), columns)


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
    digest = sha256(repr(shown).encode()).hexdigest()[:8]
    stream = rr.RecordingStream(f"{plain}-{digest}")
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
