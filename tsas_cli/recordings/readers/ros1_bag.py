"""Bags of ROS 1."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.recordings.readers.messages import Message, Topic, columns_of
from tsas_cli.recordings.readers.offered import Offered
from tsas_cli.recordings.readers.ros_types import Decode, decoder
from tsas_cli.recordings.readers.table import ReadOptions, optional


@contextmanager
def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the fields of all topics."""
    del options
    rosbag = optional("rosbags.rosbag1", extra="robots")
    with rosbag.Reader(path) as bag:
        topics = []
        for one in bag.connections:
            decode = decoder(one.msgtype, one.msgdef.data, ros1=True)
            topics.append(Topic(one.topic, one.msgtype, partial(_messages, bag, one, decode)))
        yield Offered(columns_of(topics))


def _messages(bag: Any, connection: Any, decode: Decode) -> Iterator[Message]:
    for _, time_ns, data in bag.messages(connections=[connection]):
        yield time_ns, decode(data)
