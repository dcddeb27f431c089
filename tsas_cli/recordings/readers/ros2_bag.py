"""Bags of ROS 2: the SQLite file in their folder."""

import shlex
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

from tsas_cli.recordings.readers.messages import (
    Message,
    Topic,
    columns_of,
    decoder,
)
from tsas_cli.recordings.readers.offered import Offered
from tsas_cli.recordings.readers.table import ReadOptions

_TOPICS = "SELECT id, name, type FROM topics WHERE serialization_format = 'cdr' ORDER BY id"
_TEXTS = (
    "SELECT topic_type, encoded_message_definition FROM message_definitions "
    "WHERE encoding = 'ros2msg'"
)
_MESSAGES = "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp, id"


@contextmanager
def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the fields of all topics whose type is defined in the file, or by ROS 2 itself.

    InputError: there is none.
    """
    del options
    address = f"{path.absolute().as_uri()}?mode=ro&immutable=1"
    with closing(sqlite3.connect(address, uri=True)) as file:
        try:
            texts = dict(file.execute(_TEXTS))
        except sqlite3.OperationalError:  # bags hold definitions since Iron
            texts = {}
        topics = [
            Topic(name, kind, partial(_messages, file, number, kind, texts.get(kind, "")))
            for number, name, kind in file.execute(_TOPICS).fetchall()
        ]
        remedy = (
            "convert it where its types are installed: "
            f"echo 'output_bags: [{{uri: made, storage_id: mcap, all: true}}]' > made.yaml && "
            f"ros2 bag convert -i {shlex.quote(str(path.parent))} -o made.yaml"
        )
        yield Offered(columns_of(topics, path, remedy=remedy))


def _messages(
    file: sqlite3.Connection, number: int, kind: str, definition: str
) -> Iterator[Message]:
    decode = decoder(kind, definition, ros1=False)
    for time_ns, data in file.execute(_MESSAGES, (number,)):
        yield time_ns, decode(data)
