"""MCAP files: messages of ROS, or in JSON."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.recordings.readers.messages import (
    Decode,
    Message,
    Topic,
    UnknownTypeError,
    columns_of,
    decoder,
)
from tsas_cli.recordings.readers.offered import Offered
from tsas_cli.recordings.readers.table import ReadOptions, optional


@contextmanager
def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the fields of all topics whose messages can be decoded.

    InputError: there is none.
    """
    del options
    mcap = optional("mcap.reader", extra="robots")
    with path.open("rb") as stream:
        file = mcap.make_reader(stream)
        summary = file.get_summary()
        topics = []
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            kind = schema.name if schema else ""
            topics.append(Topic(channel.topic, kind, partial(_messages, file, channel, schema)))
        yield Offered(columns_of(topics, path, expected="messages of ROS 1 or 2, or in JSON"))


def _decode(channel: Any, schema: Any) -> Decode:
    encoding = channel.message_encoding
    if encoding == "json":
        return json.loads
    if encoding not in ("cdr", "ros1") or schema is None:
        raise UnknownTypeError(f"in {encoding[:40]}")
    text = schema.data.decode() if schema.encoding in ("ros2msg", "ros1msg") else ""
    return decoder(schema.name, text, ros1=encoding == "ros1")


def _messages(file: Any, channel: Any, schema: Any) -> Iterator[Message]:
    decode = _decode(channel, schema)
    for _, found, message in file.iter_messages(topics=[channel.topic]):
        if found.id == channel.id:
            yield message.publish_time, decode(message.data)
