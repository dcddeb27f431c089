"""Topics of messages, as robots record them: each field is a column with the clock of its topic."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.offered import Column
from tsas_cli.recordings.readers.records import flat
from tsas_cli.support.arrays import Floats

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


def columns_of(topics: Sequence[Topic]) -> list[Column]:
    """Return the columns of numbers, `/topic.field.field`.

    The clock of a topic is the stamp in the header of its messages, else when they were published
    or logged; it counts from the first message of the file.
    """
    used = [topic for topic in topics if topic.first]
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
