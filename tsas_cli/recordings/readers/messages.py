"""Topics of messages, as robots record them: each field is a column with the clock of its topic."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.offered import Column, flat
from tsas_cli.recordings.readers.table import optional
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

_NAME = re.compile(r"\w+(/(msg|action))?/\w+", flags=re.ASCII)
Decode = Callable[[bytes], Mapping[str, Any]]


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


_UNITS = {"force": "N", "torque": "N m"}
_STAMP = "header.stamp."
Message = tuple[int, Mapping[str, Any]]  # when it was published or logged [ns], and its fields


@dataclass(frozen=True)
class Topic:
    """One topic of a file.

    Attributes
    ----------
    name
        As in the file, `/joint_states`.
    kind
        Their type, `geometry_msgs/msg/WrenchStamped`; those of ROS have SI units.
    messages
        Yields its messages in order, each time from the first.
    """

    name: str
    kind: str
    messages: Callable[[], Iterator[Message]]

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
            partial(_values, topic, field),
            _unit(topic, field),
            times=partial(_times, topic, zero_ns),
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


def _values(topic: Topic, field: str) -> list[Any]:
    _, messages = topic.all
    return [message.get(field) for message in messages]


def _times(topic: Topic, zero_ns: int) -> Floats:
    times_ns, _ = topic.all
    return np.array([time_ns - zero_ns for time_ns in times_ns]) * 1e-9
