"""Text tables and JSON: endless lines and columns, bytes that are no text, numbers beyond all."""

from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import MAP, Case, guessing, ingesting

Made = Callable[[Path], list[object]]
Content = str | bytes | Callable[[], str]  # what is large is made when it is written
ROWS = "".join(f"{i / 100},{i % 7},{i % 5 + 1}\n" for i in range(50))


def raw(content: Content) -> bytes:
    made = content() if callable(content) else content
    return made if isinstance(made, bytes) else made.encode()


def csv(content: Content, mapping: str = MAP) -> Made:
    def make(folder: Path) -> list[object]:
        path = folder / "a.csv"
        path.write_bytes(raw(content))
        return ingesting(path, mapping)

    return make


def guessed(content: Content) -> Made:
    def make(folder: Path) -> list[object]:
        path = folder / "a.csv"
        path.write_bytes(raw(content))
        return guessing(path)

    return make


def json(content: Content) -> Made:
    def make(folder: Path) -> list[object]:
        path = folder / "a.json"
        path.write_bytes(raw(content))
        return ingesting(path)

    return make


def sparse(suffix: str, begin: bytes, size: int = 1 << 32) -> Made:
    """Return a maker of a file whose rest is a hole of NULs, which takes no room on disk."""

    def make(folder: Path) -> list[object]:
        path = folder / f"a{suffix}"
        path.write_bytes(begin)
        with path.open("r+b") as stream:
            stream.truncate(size)
        return ingesting(path)

    return make


def own_keys() -> str:
    """Records of which each has a key of its own."""
    return "[" + ",".join(f'{{"k{i}":0,"t":{i},"x":1,"f":2}}' for i in range(20_000)) + "]"


def column(values: str) -> str:
    return f'{{"t": [0, 1, 2], "x": [{values}], "f": [1, 2, 3]}}'


CASES = (
    Case(
        "a line of 4 GB of NULs",
        sparse(".csv", b"t,x,f\n"),
        "row 2: is longer than 1048576 characters",
    ),
    Case(
        "rows, then a line of 4 GB of NULs",
        sparse(".csv", b"t,x,f\n" + ROWS.encode()),
        "row 52: is longer than 1048576 characters",
    ),
    Case(
        "a first line of 40 MB",
        csv(lambda: "t,x,f" + "f" * 40_000_000 + "\n" + ROWS),
        "row 1: is longer than 1048576 characters",
    ),
    Case("a comment of 4 GB", sparse(".csv", b"# "), "is longer than 1048576 characters"),
    Case(
        "a million columns",
        csv(lambda: ",".join(f"c{i}" for i in range(10**6)) + "\n" + "1," * 999_999 + "1\n"),
        "is longer than 1048576 characters",
    ),
    Case(
        "a million columns, guessed",
        guessed(
            lambda: ",".join(f"c{i}" for i in range(10**6)) + "\n" + ("1," * 999_999 + "1\n") * 2
        ),
        "is longer than 1048576 characters",
    ),
    Case(
        "a hundred thousand columns",
        csv(lambda: "t," * 99_999 + "t\n" + "1," * 99_999 + "1\n"),
        "holds 100000 columns; expected at most 10000",
    ),
    Case("two hundred thousand comments", csv(lambda: "# no\n" * 200_000 + "t,x,f\n" + ROWS)),
    Case("NULs in rows", csv("t,x,f\n" + ROWS + "1\0,2,3\n"), "row 52: column t holds '1\\x00'"),
    Case("NULs in names", csv("t\0,x,f\n" + ROWS), "did you mean t\\x00?"),
    Case(
        "a number of 10^5 digits",
        csv("t,x,f\n" + ROWS + "9," + "1" * 100_000 + ",1\n"),
        "row 52: x_in_mm is infinite",
    ),
    Case("1e400", csv("t,x,f\n" + ROWS + "9,1e400,1\n"), "row 52: x_in_mm is infinite"),
    Case(
        "a quote that never ends",
        csv("t,x,f\n" + ROWS + '9,"1,1\n' + ROWS * 50),
        "row 52: 2 fields",
    ),
    Case("UTF-16", csv(("t,x,f\n" + ROWS).encode("utf-16")), "is not text in the encoding"),
    Case(
        "a lone surrogate",
        csv(b"t,x,f\xed\xa0\x80\n" + ROWS.encode()),
        "is not text in the encoding",
    ),
    Case(
        "two marks of UTF-8",
        csv(b"\xef\xbb\xbf" * 2 + ("t,x,f\n" + ROWS).encode()),
        "did you mean \\ufefft?",
    ),
    Case("a name of 10^5 underscores, guessed", guessed(f"t,{'_' * 100_000},f\n{ROWS}")),
    Case("a name of 10^5 letters, guessed", guessed(f"t,{'ab ' * 33_333},f\n{ROWS}")),
    Case(
        "columns of one name", csv("t,x,x,f\n" + "1,2,3,4\n2,2,3,4\n"), "2 columns have the name x"
    ),
    Case(
        "an encoding that is none",
        csv("t,x,f\n" + ROWS, MAP + '[read]\nencoding = "bz2"\n'),
        "is not text in the encoding",
    ),
    Case(
        "punycode",
        csv("t,x,f\n" + ROWS * 300, MAP + '[read]\nencoding = "punycode"\n'),
        "is not text in the encoding",
    ),
    Case(
        "an encoding with a NUL",
        csv("t,x,f\n" + ROWS, MAP + '[read]\nencoding = "a\\u0000b"\n'),
        "is not text in the encoding",
    ),
    Case(
        "a delimiter that is a line's end",
        csv("t,x,f\n" + ROWS, MAP + '[read]\ndelimiter = "\\n"\n'),
        "column t is missing",
    ),
    Case(
        "a delimiter that is a quote",
        csv("t,x,f\n" + ROWS, MAP + "[read]\ndelimiter = '\"'\n"),
        "column t is missing",
    ),
    Case(
        "10^18 lines to be skipped",
        csv("t,x,f\n" + ROWS, MAP + "[read]\nskip_lines = 1000000000000000000\n"),
        "less than or equal to 1000000000",
    ),
    Case("JSON, nested 100,000 deep", json("[" * 100_000), "is nested too deep"),
    Case("JSON, nested 100,000 deep in objects", json('{"a":' * 100_000), "is nested too deep"),
    Case("JSON, nested 300 deep", json("[" * 300 + "]" * 300), "is nested too deep"),
    Case("JSON of 4 GB", sparse(".json", b"["), "needs 107 GB of memory"),
    Case("JSON with 1e400", json(column("1, 1e400, 3")), "row 2: x_in_mm is infinite"),
    Case(
        "JSON with an integer of 10^5 digits",
        json(column("1, " + "1" * 100_000 + ", 3")),
        "an integer has thousands of digits",
    ),
    Case(
        "JSON with an integer of 4000 digits",
        json(column("1, " + "1" * 4000 + ", 3")),
        "row 2: column x holds",
    ),
    Case(
        "JSON with NaN in the time",
        json('{"t": [0, NaN, 2], "x": [1, 2, 3], "f": [1, 2, 3]}'),
        "row 2: the time is empty",
    ),
    Case(
        "JSON with text",
        json(column("\"=cmd|' /C calc'!A0\", 1, 2")),
        'row 1: column x holds "=cmd',
    ),
    Case(
        "JSON with a lone surrogate",
        json('{"t\\ud800": [1, 2, 3], "x": [1, 2, 3]}'),
        "the name of column 1 is not UTF-8",
    ),
    Case(
        "JSON with a key twice",
        json('{"t": 1, "t": [1, 2, 3], "x": [1, 2, 3], "f": [1, 2, 3]}'),
        "duplicate key 't'",
    ),
    Case("JSON behind a mark", json(b"\xef\xbb\xbf" + column("1, 2, 3").encode())),
    Case("JSON in UTF-16", json(column("1, 2, 3").encode("utf-16")), "is not JSON"),
    Case("JSON of records that share no key", json(own_keys), "holds 20003 columns"),
    Case(
        "JSON of lists in lists in cells",
        json(column("[1], [2], [3]")),
        "column x has 2 dimensions",
    ),
    Case(
        "JSON of ragged rows",
        json('{"columns": ["t", "x", "f"], "d": [[1,2,3],[1]]}'),
        "column t is missing",
    ),
    Case(
        "JSON with a number of names",
        json('{"columns": 5, "d": [[1,2,3],[1,2,3]]}'),
        "holds no table here",
    ),
    Case("JSON with objects as values", json(column("{}, {}, {}")), "row 1: column x holds '{}'"),
    Case("JSON, a number alone", json("1"), "holds no table here"),
)
