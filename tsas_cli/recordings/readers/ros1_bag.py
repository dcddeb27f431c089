"""Bags of ROS 1."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.recordings.readers.messages import Message, Topic, columns_of, decoder
from tsas_cli.recordings.readers.offered import Offered
from tsas_cli.recordings.readers.table import ReadOptions, optional


@contextmanager
def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the fields of all topics."""
    del options
    rosbag = optional("rosbags.rosbag1", extra="robots")
    with rosbag.Reader(path) as bag:
        topics = [
            Topic(one.topic, one.msgtype, partial(_messages, bag, one)) for one in bag.connections
        ]
        yield Offered(columns_of(topics, path))


def _messages(bag: Any, connection: Any) -> Iterator[Message]:
    decode = decoder(connection.msgtype, connection.msgdef.data, ros1=True)
    for _, time_ns, data in bag.messages(connections=[connection]):
        yield time_ns, decode(data)
