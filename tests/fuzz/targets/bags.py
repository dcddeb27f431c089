"""Recordings of robots: the first byte chooses the format."""

from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.foreign import Offering, whole_file
from tests.fuzz.rules import chosen
from tests.recordings.readers.bags import save_mcap, save_ros1, save_ros2

FORMATS = [whole_file(Offering("bags"), f"a.{suffix}") for suffix in ("mcap", "bag", "db3")]
SHARE = 0.1
MOST_BYTES = 50_000
WORDS = (b"#ROSBAG V2.0", b"SQLite format 3", b"MCAP0\r\n", b"float64[] a", b"msg/Force", b"cdr")


def one(data):
    reader, file = chosen(data, FORMATS)
    reader(file)


def seeds():
    with TemporaryDirectory() as name:
        folder = Path(name)
        yield b"\0" + save_mcap(folder / "a.mcap").read_bytes()
        yield b"\0" + save_ros2(folder / "c", mcap=True).read_bytes()
        yield b"\1" + save_ros1(folder / "a.bag").read_bytes()
        yield b"\2" + save_ros2(folder / "b").read_bytes()
