"""Messages of ROS, decoded by the definitions that their file holds, or by those of ROS itself."""

import re
from collections.abc import Callable, Mapping
from typing import Any

from tsas_cli.recordings.readers.table import optional

_NAME = re.compile(r"\w+(/(msg|action))?/\w+", flags=re.ASCII)
Decode = Callable[[bytes], Mapping[str, Any]]


class UnknownTypeError(Exception):
    """A type of messages is neither defined in the file nor one of ROS."""


def decoder(kind: str, definition: str, *, ros1: bool) -> Decode:
    """Return the function that decodes messages of a type.

    Parameters
    ----------
    kind
        The type, `sensor_msgs/msg/JointState`.
    definition
        Its text in the language of `.msg` files with all that it refers to; may be empty.

    Raises
    ------
    UnknownTypeError
        The type is not defined.
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
