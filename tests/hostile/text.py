"""Text tables and JSON: endless lines and columns, bytes that are no text, numbers beyond all."""

from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import MAP, Make, cases, guessing, ingesting

Content = str | bytes | Callable[[], str]  # what is large is made when it is written
ROWS = "".join(f"{i / 100},{i % 7},{i % 5 + 1}\n" for i in range(50))
HONEST = "t,x,f\n" + ROWS


def written(name: str, content: Content, call: Callable[[Path], list[object]]) -> Make:
    def make(folder: Path) -> list[object]:
        made = content() if callable(content) else content
        (folder / name).write_bytes(made if isinstance(made, bytes) else made.encode())
        return call(folder / name)

    return make


def csv(content: Content) -> Make:
    return written("a.csv", content, ingesting)


def rows(also: str) -> Make:
    """Return a maker of an honest table with more behind it."""
    return csv(HONEST + also)


def read(option: str) -> Make:
    """Return a maker of an honest table that the map says to read so."""
    mapping = f"{MAP}[read]\n{option}\n"
    return written("a.csv", HONEST, lambda path: ingesting(path, mapping))


def guessed(content: Content) -> Make:
    return written("a.csv", content, guessing)


def json(content: Content) -> Make:
    return written("a.json", content, ingesting)


def sparse(suffix: str, begin: bytes) -> Make:
    """Return a maker of a file whose rest is a hole of NULs, 4 GB that take no room on disk."""

    def make(folder: Path) -> list[object]:
        path = folder / f"a{suffix}"
        path.write_bytes(begin)
        with path.open("ab") as stream:
            stream.truncate(1 << 32)
        return ingesting(path)

    return make


def own_keys() -> str:
    """Records of which each has a key of its own."""
    return "[" + ",".join(f'{{"k{i}":0,"t":{i},"x":1,"f":2}}' for i in range(20_000)) + "]"


def column(values: str) -> Make:
    return json(f'{{"t": [0, 1, 2], "x": [{values}], "f": [1, 2, 3]}}')


def million() -> str:
    return ",".join(f"c{i}" for i in range(10**6)) + "\n" + ("1," * 999_999 + "1\n") * 2


CASES = cases(
    {
        "row 2: is longer than 1048576 characters": {
            "a line of 4 GB of NULs": sparse(".csv", b"t,x,f\n"),
        },
        "row 52: is longer than 1048576 characters": {
            "rows, then a line of 4 GB of NULs": sparse(".csv", HONEST.encode()),
        },
        "row 1: is longer than 1048576 characters": {
            "a first line of 40 MB": csv(lambda: "f" * 40_000_000 + "\n" + HONEST),
        },
        "is longer than 1048576 characters": {
            "a comment of 4 GB": sparse(".csv", b"# "),
            "a million columns": csv(million),
            "a million columns, guessed": guessed(million),
        },
        "holds 100000 columns; expected at most 10000": {
            "a hundred thousand columns": csv(
                lambda: "t," * 99_999 + "t\n" + "1," * 99_999 + "1\n"
            ),
        },
        "row 52: column t holds '1\\x00'": {"NULs in rows": rows("1\0,2,3\n")},
        "row 52: x_in_mm is infinite": {
            "a number of 10^5 digits": rows("9," + "1" * 100_000 + ",1\n"),
            "1e400": rows("9,1e400,1\n"),
        },
        "row 52: 2 fields": {"a quote that never ends": rows('9,"1,1\n' + ROWS * 50)},
        "is not text in the encoding": {
            "NULs in names": csv(f"t\0{HONEST[1:]}"),
            "UTF-16": csv(HONEST.encode("utf-16")),
            "a lone surrogate": csv(b"t,x,f\xed\xa0\x80\n" + ROWS.encode()),
            "punycode": written(
                "a.csv",
                HONEST + ROWS * 299,
                lambda path: ingesting(path, MAP + '[read]\nencoding = "punycode"\n'),
            ),
        },
        "read.encoding of the map: the encoding": {
            "an encoding that is none": read('encoding = "bz2"'),
            "an encoding with a NUL": read('encoding = "a\\u0000b"'),
        },
        "did you mean \\ufefft?": {
            "two marks of UTF-8": csv(b"\xef\xbb\xbf" * 2 + HONEST.encode()),
        },
        "2 columns have the name x": {"columns of one name": csv("t,x,x,f\n1,2,3,4\n2,2,3,4\n")},
        "column t is missing": {
            "a delimiter that is a line's end": read('delimiter = "\\n"'),
            "a delimiter that is a quote": read("delimiter = '\"'"),
            "JSON of ragged rows": json('{"columns": ["t", "x", "f"], "d": [[1,2,3],[1]]}'),
        },
        "less than or equal to 1000000000": {
            "10^18 lines to be skipped": read("skip_lines = 1000000000000000000"),
        },
        "is nested too deep": {
            "JSON, nested 100,000 deep": json("[" * 100_000),
            "JSON, nested 100,000 deep in objects": json('{"a":' * 100_000),
            "JSON, nested 300 deep": json("[" * 300 + "]" * 300),
        },
        "needs 107 GB of memory": {"JSON of 4 GB": sparse(".json", b"[")},
        "row 2: x_in_mm is infinite": {"JSON with 1e400": column("1, 1e400, 3")},
        "an integer has thousands of digits": {
            "JSON with an integer of 10^5 digits": column("1, " + "1" * 100_000 + ", 3"),
        },
        "row 2: column x holds": {
            "JSON with an integer of 4000 digits": column("1, " + "1" * 4000 + ", 3"),
        },
        "row 2: the time is empty": {
            "JSON with NaN in the time": json('{"t": [0, NaN, 2], "x": [1, 2, 3], "f": [1, 2, 3]}'),
        },
        'row 1: column x holds "=cmd': {
            "JSON with text": column("\"=cmd|' /C calc'!A0\", 1, 2"),
        },
        "the name of column 1 is not UTF-8": {
            "JSON with a lone surrogate": json('{"t\\ud800": [1, 2, 3], "x": [1, 2, 3]}'),
        },
        "duplicate key 'x'": {"JSON with a key twice": column('1, 2, 3], "x": [1, 2, 3')},
        "is not JSON": {"JSON in UTF-16": json('{"t": [0, 1], "x": [1, 2]}'.encode("utf-16"))},
        "holds 20003 columns": {"JSON of records that share no key": json(own_keys)},
        "column x has 2 dimensions": {"JSON of lists in lists in cells": column("[1], [2], [3]")},
        "holds no table here": {
            "JSON with a number of names": json('{"columns": 5, "d": [[1,2,3],[1,2,3]]}'),
            "JSON, a number alone": json("1"),
        },
        "row 1: column x holds '{}'": {"JSON with objects as values": column("{}, {}, {}")},
        "": {
            "two hundred thousand comments": csv(lambda: "# no\n" * 200_000 + HONEST),
            "a name of 10^5 underscores, guessed": guessed(f"t,{'_' * 100_000},f\n{ROWS}"),
            "a name of 10^5 letters, guessed": guessed(f"t,{'ab ' * 33_333},f\n{ROWS}"),
            "JSON behind a mark": json(b'\xef\xbb\xbf{"t": [0, 1], "x": [1, 2], "f": [1, 2]}'),
        },
    }
)
