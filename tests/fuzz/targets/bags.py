"""Recordings of robots: the first byte chooses the format."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.foreign import Offering, ask
from tests.fuzz.rules import Scratch
from tests.recordings.readers.bags import save_mcap, save_ros1, save_ros2
from tsas_cli.recordings.readers import bags  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SUFFIXES = (".mcap", ".bag", ".db3")
SHARE = 0.1
MOST_BYTES = 50_000
WORDS = (
    b"#ROSBAG V2.0",
    b"SQLite format 3",
    b"MCAP0\r\n",
    b"float64[] a",
    b"own/msg/Force",
    b"cdr",
)
_scratch = Scratch()


def one(data: bytes) -> None:
    """The rest is the file."""
    suffix = SUFFIXES[data[0] % 3 if data else 0]
    ask(Offering("bags"), _scratch.file(f"a{suffix}", data[1:]), ReadOptions())


def seeds() -> Iterable[bytes]:
    """Two topics in each of the formats."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        yield b"\0" + save_mcap(folder / "a.mcap").read_bytes()
        yield b"\0" + save_ros2(folder / "c", mcap=True).read_bytes()
        yield b"\1" + save_ros1(folder / "a.bag").read_bytes()
        yield b"\2" + save_ros2(folder / "b").read_bytes()
