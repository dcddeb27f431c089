"""Recordings of robots: a joint's state with a stamp, and a force without one."""

import json
from pathlib import Path

import numpy as np
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Bag1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

START_NS = 1_772_532_000_000_000_000
JOINTS = 5  # messages at 10 Hz, sent 1 ms before they are logged
FORCES = 9  # at 20 Hz
OWN_TYPE = "float64 newton\nint32[2] counts\nstring note\n"  # no type of ROS


def save_mcap(path: Path) -> Path:
    """Write both topics as JSON."""
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start()
        schema = writer.register_schema(name="any", encoding="jsonschema", data=b"{}")
        for topic, messages in _plain().items():
            channel = writer.register_channel(topic, "json", schema)
            for logged, message in messages:
                data = json.dumps(message).encode()
                writer.add_message(channel, logged, data, logged)
        writer.finish()
    return path


def _plain():  # type: ignore[no-untyped-def]
    """Return the messages of each topic, with the time at which each is logged [ns]."""
    joints, forces = [], []
    for i in range(JOINTS):
        sent_ns = START_NS + i * 100_000_000
        stamp = {"sec": sent_ns // 10**9, "nanosec": sent_ns % 10**9}
        message = {"header": {"stamp": stamp}, "position": [i / 10], "name": ["a"]}
        joints.append((sent_ns + 1_000_000, message))
    for i in range(FORCES):
        message = {"newton": 5.0 * i, "counts": [i, 7], "note": "a"}
        forces.append((START_NS + i * 50_000_000, message))
    return {"/joint": joints, "/force": forces}


def save_ros1(path: Path) -> Path:
    """Write a bag of ROS 1."""
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg(OWN_TYPE, "own/msg/Force"))
    with Bag1(path) as bag:
        _fill(bag, store, store.serialize_ros1, seq=0)
    return path


def save_ros2(folder: Path, *, mcap: bool = False) -> Path:
    """Write a bag of ROS 2; return the file in its folder."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(OWN_TYPE, "own/msg/Force"))
    kind = StoragePlugin.MCAP if mcap else StoragePlugin.SQLITE3
    with Bag2(folder, version=9, storage_plugin=kind) as bag:
        _fill(bag, store, store.serialize_cdr)
    return next(folder.glob("*.mcap" if mcap else "*.db3"))


def _fill(bag, store, serialize, **header):  # type: ignore[no-untyped-def]
    own, joint_state = "own/msg/Force", "sensor_msgs/msg/JointState"
    kinds = (joint_state, own, "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    state, force, head, time = (store.types[kind] for kind in kinds)
    joint = bag.add_connection("/joint", joint_state, typestore=store)
    forces = bag.add_connection("/force", own, typestore=store)
    plain = _plain()
    for logged, m in plain["/joint"]:
        stamp = head(**header, stamp=time(**m["header"]["stamp"]), frame_id="")
        empty = np.array([])
        message = state(stamp, ["a"], np.array(m["position"]), empty, empty)
        bag.write(joint, logged, serialize(message, joint_state))
    for logged, m in plain["/force"]:
        message = force(m["newton"], np.array(m["counts"], dtype=np.int32), m["note"])
        bag.write(forces, logged, serialize(message, own))
