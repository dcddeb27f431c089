"""Recordings of robots: each field is a column, with the clock of its topic."""

import sqlite3
from pathlib import Path

import numpy as np
import pytest

from tests.recordings.readers.bags import FORCES, JOINTS, save_mcap, save_ros1, save_ros2
from tsas_cli.recordings.guess.opening import open_file
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.bags import Topic, columns_of
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

MADE = {
    "json.mcap": save_mcap,
    "ros1.bag": save_ros1,
    "ros2.db3": lambda path: save_ros2(path.with_suffix("")),
    "ros2.mcap": lambda path: save_ros2(path.with_suffix(""), mcap=True),
}
BOTH = ["/joint.position[0]", "/force.newton"]


@pytest.fixture(scope="module", params=list(MADE))
def bag(request, tmp_path_factory):
    return MADE[request.param](tmp_path_factory.mktemp("bag") / request.param)


def test_every_field_of_numbers_is_a_column(bag):
    expected = {*BOTH, "/force.counts[0]", "/force.counts[1]", "time"}
    assert expected == set(names(bag, ReadOptions()))


def test_a_topic_comes_with_its_own_clock(bag):
    """That of the stamp in the header, where it has one."""
    force = read(bag, ReadOptions(), ["time", BOTH[1], "/force.counts[0]"]).columns
    np.testing.assert_allclose(force["time"], np.arange(FORCES) / 20, atol=1e-9)
    np.testing.assert_array_equal(force[BOTH[1]], 5.0 * np.arange(FORCES))
    np.testing.assert_array_equal(force["/force.counts[0]"], np.arange(FORCES))

    joint = read(bag, ReadOptions(), ["time", BOTH[0]]).columns
    np.testing.assert_allclose(joint["time"], np.arange(JOINTS) / 10, atol=1e-9)


def test_topics_go_onto_one_clock_when_the_map_says_so(bag):
    with pytest.raises(InputError, match="the channels have different times"):
        read(bag, ReadOptions(), ["time", *BOTH])
    table = read(bag, ReadOptions(resample=True), ["time", *BOTH])
    np.testing.assert_allclose(table.columns[BOTH[0]], np.arange(FORCES) / 20, atol=1e-9)
    assert table.units == {"time": "s"}


def test_the_guess_lists_the_fields(bag):
    opened = open_file(bag)
    assert opened.read["resample"][0] is True
    assert set(BOTH) <= set(opened.names.values())


def test_a_bag_without_definitions_is_read_by_those_of_ros(tmp_path):
    path = save_ros2(tmp_path / "a")
    with sqlite3.connect(path) as file:
        file.execute("DROP TABLE message_definitions")
    assert names(path, ReadOptions()) == (BOTH[0], "time")
    with sqlite3.connect(path) as file:
        file.execute("DELETE FROM topics WHERE type LIKE 'sensor%'")
    with pytest.raises(InputError, match=r"/force \(own/msg/Force\).*storage_id: mcap"):
        names(path, ReadOptions())


def test_a_type_is_no_program(tmp_path):
    path = save_ros2(tmp_path / "a")
    with sqlite3.connect(path) as file:
        file.execute("UPDATE topics SET type = 'a/msg/B: pass\nimport os\nclass C'")
    with pytest.raises(InputError, match="no messages that can be decoded"):
        names(path, ReadOptions())


@pytest.mark.parametrize(
    ("kind", "field", "unit"),
    [
        ("geometry_msgs/msg/WrenchStamped", "wrench.force.x", "N"),
        ("geometry_msgs/msg/Wrench", "torque.z", "N m"),
        ("geometry_msgs/msg/Pose", "position.x", ""),
        ("own/msg/Wrench", "force.x", ""),
    ],
)
def test_forces_and_torques_of_ros_have_units(kind, field, unit):
    first, second = field.split(".", 1)
    topic = Topic("/t", kind, lambda: iter([(0, {first: {second: 1.0}})]))
    (column,) = columns_of([topic], Path("a.mcap"))
    assert (column.name, column.unit) == (f"/t.{field}", unit)
