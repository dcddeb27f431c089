"""The map of `tsas ingest`."""

from pathlib import Path

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, answer
from tsas_cli.recordings.ingest_map import read_map

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 25
WORDS = (b"[columns.", b"[run.table.", b"pattern = '(?P<", b"rate_Hz", b'"first"', b"[[", b"= [")
MAPS = Path(__file__).parents[3] / "datasets" / "maps"
_scratch = Scratch()


def one(data):
    """A map that is taken names its sources."""
    mapping = answer(read_map, _scratch.file("map.toml", data))
    if mapping is not None:
        mapping.sources()


def seeds():
    for path in sorted(MAPS.glob("*.toml")):
        yield b"\n".join(s for s in path.read_bytes().splitlines() if not s.startswith(b"#"))
    yield b"""[dataset]
name = "a"
[rig]
tendon_diameter_mm = 1.2
[read]
delimiter = ";"
extra = ["a", 3]
[columns]
time_s = {rate_Hz = 1000}
x_in_mm = {source = 2, unit = "deg", pulley_radius_mm = 5.0, sign = -1, offset = "first"}
f_in_N = {source = "f", unit = "V", factor = 10, factor_unit = "N"}
[run]
id = "{stem}"
from_file_name = {pattern = 'a(?P<preload_N>\\d+)'}
conditions = {total_bend_rad = {from = "bend", unit = "deg"}}
table = {a = {preload_N = 3.0}}
"""
