"""Recordings of robots: bags of ROS 1 and 2, and MCAP. Each field of a topic is a column."""

import json
import re
import shlex
import sqlite3
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.offered import Column, Offered, flat
from tsas_cli.recordings.readers.table import ReadOptions, optional
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

_NAME = re.compile(r"\w+(/(msg|action))?/\w+", flags=re.ASCII)
Decode = Callable[[bytes], Mapping[str, Any]]
_UNITS = {"force": "N", "torque": "N m"}
_STAMP = "header.stamp."
Message = tuple[int, Mapping[str, Any]]  # when it was published or logged [ns], and its fields
_TOPICS = "SELECT id, name, type FROM topics WHERE serialization_format = 'cdr' ORDER BY id"
_TEXTS = (
    "SELECT topic_type, encoded_message_definition FROM message_definitions "
    "WHERE encoding = 'ros2msg'"
)
_MESSAGES = "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp, id"


class UnknownTypeError(Exception):
    """A type of messages is neither defined in the file nor one of ROS."""


@cache
def decoder(kind: str, definition: str, *, ros1: bool) -> Decode:
    """Return the function that decodes messages of a type.

    `kind` is such as `sensor_msgs/msg/JointState`, `definition` its text in the language of `.msg`
    files with all that it refers to; may be empty.

    UnknownTypeError: the type is not defined.
    """
    typesys = optional("rosbags.typesys", extra="robots")
    if not _NAME.fullmatch(kind):  # it becomes part of a program
        raise UnknownTypeError(kind[:80])
    stores = typesys.Stores
    store = typesys.get_typestore(stores.ROS1_NOETIC if ros1 else stores.ROS2_HUMBLE)
    name = kind if kind.count("/") == 2 else kind.replace("/", "/msg/")
    if definition:
        defined = typesys.get_types_from_msg(definition, name)
        store.register({n: d for n, d in defined.items() if n not in store.fielddefs})
    if name not in store.fielddefs:
        raise UnknownTypeError(name)
    decode = store.deserialize_ros1 if ros1 else store.deserialize_cdr
    return lambda data: vars(decode(data, name))


@dataclass(frozen=True)
class Topic:
    """One topic of a file."""

    name: str  # as in the file, `/joint_states`
    kind: str  # `geometry_msgs/msg/WrenchStamped`; those of ROS have SI units
    messages: Callable[[], Iterator[Message]]  # in order, each time from the first

    @cached_property
    def first(self) -> Mapping[str, Any]:
        """The fields of the first message by their paths; empty without messages."""
        return next((dict(flat(fields)) for _, fields in self.messages()), {})

    @cached_property
    def all(self) -> tuple[list[int], list[dict[str, Any]]]:
        """When the messages were sent [ns], and their fields by their paths."""
        logged, fields = [], []
        for time_ns, message in self.messages():
            logged.append(time_ns)
            fields.append(dict(flat(message)))
        sent = [_sent_ns(one) for one in fields]
        return (sent if sent and all(sent) else logged), fields

    def values(self, field: str) -> list[Any]:
        """Return a field of all messages, None where it is missing."""
        return [message.get(field) for message in self.all[1]]

    def times(self, zero_ns: int) -> Floats:
        """Return when the messages were sent since a moment [s], shape (n,)."""
        return np.array([time_ns - zero_ns for time_ns in self.all[0]]) * 1e-9


_Topics = Iterator[tuple[list[Topic], dict[str, str]]]  # and advice where none can be decoded


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the fields of all topics whose type is defined in the file, or by ROS itself.

    InputError: there is none.
    """
    with _TOPICS_OF[path.suffix.lower()](path) as (topics, advice):
        yield Offered(columns_of(topics, path, **advice))


def columns_of(topics: Sequence[Topic], path: Path, **advice: str) -> list[Column]:
    """Return the columns of numbers, `/topic.field.field`, of the topics that can be decoded.

    The clock of a topic is the stamp in the header of its messages, else when they were published
    or logged; it counts from the first message of the file.

    InputError: no topic can be decoded; `advice` says what is expected, or what to do.
    """
    used, unknown = [], []
    for topic in topics:
        try:
            used += [topic] if topic.first else []
        except UnknownTypeError as error:
            unknown.append(f"{topic.name} ({error})")
    if len(unknown) == len(topics):
        said = "".join(f": {one}" for one in unknown[:3])
        raise InputError(f"holds no messages that can be decoded{said}", where=path, **advice)
    zero_ns = min((next(topic.messages())[0] for topic in used), default=0)
    return [
        Column(
            f"{topic.name}.{field}",
            partial(topic.values, field),
            _unit(topic, field),
            times=partial(topic.times, zero_ns),
        )
        for topic in used
        for field, value in topic.first.items()
        if isinstance(value, int | float | np.number) and not field.startswith("header.")
    ]


def _unit(topic: Topic, field: str) -> str:
    """Return the unit of a force or a torque in a message of ROS; a joint may turn or slide."""
    if not topic.kind.startswith("geometry_msgs/"):
        return ""
    return next((unit for of, unit in _UNITS.items() if f".{of}." in f".{field}"), "")


def _sent_ns(fields: Mapping[str, Any]) -> int:
    """Return the stamp in a message's header [ns], 0 without one."""
    nanoseconds = fields.get(f"{_STAMP}nanosec", fields.get(f"{_STAMP}nsec", 0))
    return int(fields.get(f"{_STAMP}sec", 0)) * 10**9 + int(nanoseconds)


@contextmanager
def _of_ros1(path: Path) -> _Topics:
    rosbag = optional("rosbags.rosbag1", extra="robots")
    with rosbag.Reader(path) as bag:
        connections = bag.connections
        yield [Topic(one.topic, one.msgtype, partial(_ros1, bag, one)) for one in connections], {}


def _ros1(bag: Any, connection: Any) -> Iterator[Message]:
    decode = decoder(connection.msgtype, connection.msgdef.data, ros1=True)
    for _, time_ns, data in bag.messages(connections=[connection]):
        yield time_ns, decode(data)


@contextmanager
def _of_ros2(path: Path) -> _Topics:
    """Yield the topics of the SQLite file in the folder of a bag."""
    address = f"{path.absolute().as_uri()}?mode=ro&immutable=1"
    with closing(sqlite3.connect(address, uri=True)) as file:
        try:
            texts = dict(file.execute(_TEXTS))
        except sqlite3.OperationalError:  # bags hold definitions since Iron
            texts = {}
        topics = [
            Topic(name, kind, partial(_ros2, file, number, kind, texts.get(kind, "")))
            for number, name, kind in file.execute(_TOPICS).fetchall()
        ]
        remedy = (
            "convert it where its types are installed: "
            f"echo 'output_bags: [{{uri: made, storage_id: mcap, all: true}}]' > made.yaml && "
            f"ros2 bag convert -i {shlex.quote(str(path.parent))} -o made.yaml"
        )
        yield topics, {"remedy": remedy}


def _ros2(file: sqlite3.Connection, number: int, kind: str, definition: str) -> Iterator[Message]:
    decode = decoder(kind, definition, ros1=False)
    for time_ns, data in file.execute(_MESSAGES, (number,)):
        yield time_ns, decode(data)


@contextmanager
def _of_mcap(path: Path) -> _Topics:
    """Yield the topics of ROS, or in JSON."""
    mcap = optional("mcap.reader", extra="robots")
    with path.open("rb") as stream:
        file = mcap.make_reader(stream)
        summary = file.get_summary()
        topics = []
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            kind = schema.name if schema else ""
            topics.append(Topic(channel.topic, kind, partial(_mcap, file, channel, schema)))
        yield topics, {"expected": "messages of ROS 1 or 2, or in JSON"}


def _mcap(file: Any, channel: Any, schema: Any) -> Iterator[Message]:
    encoding = channel.message_encoding
    decode: Decode = json.loads
    if encoding != "json":
        if encoding not in ("cdr", "ros1") or schema is None:
            raise UnknownTypeError(f"in {encoding[:40]}")
        text = schema.data.decode() if schema.encoding in ("ros2msg", "ros1msg") else ""
        decode = decoder(schema.name, text, ros1=encoding == "ros1")
    for _, found, message in file.iter_messages(topics=[channel.topic]):
        if found.id == channel.id:
            yield message.publish_time, decode(message.data)


_TOPICS_OF = {".bag": _of_ros1, ".db3": _of_ros2, ".mcap": _of_mcap}
