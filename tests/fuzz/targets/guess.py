"""Files that nobody has described yet, for which a map is proposed."""

import json
import math

from tests.fuzz.rules import Broken, Scratch, answer, chosen
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.guess.text import content, tables
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.recordings.readers import delimited, json_table, parquet  # noqa: F401 # instrumented

SUFFIXES = (".csv", ".txt", ".json", ".parquet")
SHARE = 1
WORDS = (b"time", b"[ms]", b"f_in (N)", b"Weg", b"motor", b"\r\n", b"[[", b'"data"', b"counts")
_scratch = Scratch()


def one(data):
    """The map that is proposed can be printed and read; the first byte chooses the format."""
    suffix, file = chosen(data, SUFFIXES)
    proposal = answer(propose, [_scratch.file(f"a{suffix}", file)])
    if proposal is None:
        return
    told = content(proposal)
    list(tables(proposal, "map.toml"))
    text = told["map"]
    if not all(line.isprintable() for line in text.split("\n")):
        raise Broken(f"a map that cannot be printed: {text!r}")
    mapping = answer(read_map, _scratch.file("map.toml", text.encode()))
    if (mapping is not None) != ("No question is open: the map is ready" in text):
        raise Broken("a map says that it is taken, and is refused, or the other way round")


def seeds():
    rows = [
        [0.001 * i, 10 - 10 * math.cos(0.4 * i), 25 + 10 * math.sin(0.4 * i), 20 + i % 7]
        for i in range(40)
    ]
    lines = ["; ".join(f"{x:.4g}" for x in row) for row in rows]
    yield b"\0" + "\n".join(["time [s]; x_in [mm]; f_in [N]; load", *lines]).encode()
    yield b"\0" + "\n".join(["rig 3", "recorded by me", "", *lines]).encode()
    yield b"\1" + "\n".join("\t".join(line.split("; ")) for line in lines).encode()
    log = {"columns": ["t", "x_in", "f_in", "c"], "rows": rows}
    yield b"\2" + json.dumps({"log": log}).encode()
