"""Tables of known numbers, written in any layout of any format, and read again."""

import csv
import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from asammdf import MDF, Signal
from hypothesis import strategies as st
from scipy.io import savemat

from tests.recordings.readers.matlab_files import controldesk, save_struct_73
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.layout import may_be_thousands
from tsas_cli.recordings.readers.table import ReadOptions

LETTERS = "abcdxyzFT_µé°/²-"
finite = st.floats(allow_nan=False, allow_infinity=False)


@dataclass(frozen=True)
class Known:
    """What a file holds, by the source that a map names it with, and what a map says about it."""

    suffix: str
    content: bytes
    columns: dict[str | int, list[float]]
    options: dict[str, Any] = field(default_factory=dict)
    units: dict[str | int, str] = field(default_factory=dict)


def check(known: Known, folder: Path) -> None:
    """Read a file, and compare every number bit by bit."""
    path = folder / f"a{known.suffix}"
    path.write_bytes(known.content)
    options = ReadOptions.model_validate(known.options)
    assert len(names(path, options)) >= len(known.columns)
    table = read(path, options, list(known.columns))
    for source, values in known.columns.items():
        expected = np.array(values, dtype=np.float64)
        found = np.where(np.isnan(table.columns[source]), np.nan, table.columns[source])
        np.testing.assert_array_equal(found.view(np.int64), expected.view(np.int64))
    assert {s: u for s, u in table.units.items() if s in known.units} == known.units


@st.composite
def columns_of_numbers(draw: st.DrawFn, least: int = 1, most: int = 4) -> list[list[float]]:
    """Draw columns of one length; a gap is NaN; the first column has none."""
    rows = draw(st.integers(least, 6))
    cell = st.one_of(finite, st.just(float("nan")))
    kinds = [finite, *[cell] * draw(st.integers(0, most - 1))]
    return [draw(st.lists(kind, min_size=rows, max_size=rows)) for kind in kinds]


def words() -> st.SearchStrategy[str]:
    """Draw a name that is no number and no gap."""
    return st.text(LETTERS, min_size=1, max_size=5).map(lambda w: f"n{w}")


def titles_of(count: int) -> st.SearchStrategy[list[str]]:
    return st.lists(words(), min_size=count, max_size=count, unique=True)


@st.composite
def text_tables(draw: st.DrawFn) -> Known:
    """Draw a table as text, with or without names, units, comments and blank lines."""
    columns = draw(columns_of_numbers())
    count = len(columns)
    delimiter = draw(st.sampled_from([",", ";", "\t", " "]))
    comma = delimiter != "," and draw(st.booleans())
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"]))
    titles = draw(titles_of(count))
    units = draw(st.lists(st.sampled_from(["mm", "N", "s", "µm"]), min_size=count, max_size=count))
    has_names = draw(st.booleans())
    where = draw(st.sampled_from(["nowhere", "bracket", "row"])) if has_names else "nowhere"
    gap = draw(st.sampled_from(["nan", "NaN", "NULL", *([] if delimiter == " " else [""])]))
    form = draw(st.sampled_from(["{!r}", "{:.17g}", "{:.17e}", "{:+.17g}", "{:.17G}"]))
    gap = gap if count > 1 else gap or "nan"
    rows = [
        [_cell(value, form, gap, comma=comma) for value in row]
        for row in zip(*columns, strict=True)
    ]
    if where == "bracket":
        glue = "" if delimiter == " " else draw(st.sampled_from(["", " "]))
        titles = [f"{t}{glue}[{u}]" for t, u in zip(titles, units, strict=True)]
    head = [titles] if has_names else []
    head += [units] if where == "row" else []
    quoted = csv.QUOTE_ALL if delimiter != " " and draw(st.booleans()) else csv.QUOTE_MINIMAL
    lines = [_line(cells, delimiter, quoted) for cells in [*head, *rows]]
    comments = draw(st.lists(words().map(lambda w: f"# {w}"), max_size=2))
    if not has_names and comments:  # the last one would give names, if it had as many fields
        comments[-1] = "# " + _line(["n"] * (count + 1), delimiter, csv.QUOTE_MINIMAL)
    blank = draw(st.integers(0, len(lines)))
    lines = [*comments, *lines[:blank], "", *lines[blank:]]
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    content = end.join(lines) + (end if draw(st.booleans()) else "")
    options: dict[str, Any] = {} if encoding.startswith("utf-8") else {"encoding": encoding}
    doubtful = any(may_be_thousands(cell) for row in rows for cell in row)
    guessable = count > 1 and not (comma and (delimiter == " " or doubtful))
    if not guessable or draw(st.booleans()):
        options |= {"delimiter": delimiter, "decimal": "," if comma else "."}
    by_name = has_names and draw(st.booleans())
    sources: list[str | int] = list(titles) if by_name else list(range(1, count + 1))
    declared = dict(zip(sources, units, strict=True)) if where != "nowhere" else {}
    data = dict(zip(sources, columns, strict=True))
    return Known(
        draw(st.sampled_from([".csv", ".txt"])), content.encode(encoding), data, options, declared
    )


def _cell(value: float, form: str, gap: str, *, comma: bool) -> str:
    text = gap if value != value else form.format(value)
    return text.replace(".", ",") if comma else text


def _line(cells: list[str], delimiter: str, quoted: int) -> str:
    if delimiter == " ":
        return "  ".join(cells)
    stream = io.StringIO()
    csv.writer(stream, delimiter=delimiter, quoting=quoted, lineterminator="").writerow(cells)  # type: ignore[arg-type]
    return stream.getvalue()


@st.composite
def json_tables(draw: st.DrawFn) -> Known:
    """Draw a table as JSON: rows, records or columns, at the top or under a key."""
    columns = draw(columns_of_numbers())
    count = len(columns)
    titles = draw(titles_of(count))
    plain = [[None if v != v else v for v in column] for column in columns]
    rows = [list(row) for row in zip(*plain, strict=True)]
    form = draw(st.sampled_from(["rows", "named rows", "records", "columns"]))
    sources: list[str | int] = list(titles)
    table: Any = dict(zip(titles, plain, strict=True))
    above: dict[str, Any] = {"note": "a"}
    if form == "rows":
        table, sources = rows, list(range(1, count + 1))
    elif form == "named rows":
        table, above["columns"] = rows, titles
    elif form == "records":
        table = [
            {t: v for t, v in zip(titles, row, strict=True) if i == 0 or v is not None}
            for i, row in enumerate(rows)
        ]
    data = dict(zip(sources, columns, strict=True))
    if form != "named rows" and draw(st.booleans()):
        return Known(".json", json.dumps(table).encode(), data)
    content = json.dumps({"deep": above | {"data": table}}).encode()
    return Known(".json", content, data, {"table": "deep.data"})


@st.composite
def parquet_tables(draw: st.DrawFn) -> Known:
    """Draw a Parquet file of some type, compression and layout."""
    columns = draw(columns_of_numbers())
    count = len(columns)
    titles = draw(titles_of(count))
    kind = draw(st.sampled_from([pa.float64(), pa.float32(), pa.int16(), pa.int64()]))
    if kind == pa.float32():
        with np.errstate(over="ignore"):
            columns = [np.float32(np.clip(c, -3e38, 3e38)).tolist() for c in columns]
    elif kind != pa.float64():
        whole = st.integers(-(2**15), 2**15 - 1)
        columns = [[float(draw(whole)) for _ in column] for column in columns]
    fields = [pa.field(t, kind, metadata={"unit": "mm"}) for t in titles]
    arrays = [pa.array(np.array(c), pa.float64(), from_pandas=True).cast(kind) for c in columns]
    stream = io.BytesIO()
    pq.write_table(
        pa.table(arrays, schema=pa.schema(fields)),
        stream,
        compression=draw(st.sampled_from(["none", "snappy", "gzip", "zstd"])),
        use_dictionary=draw(st.booleans()),
        data_page_version=draw(st.sampled_from(["1.0", "2.0"])),
        row_group_size=draw(st.integers(1, 3)),
    )
    units: dict[str | int, str] = dict.fromkeys(titles, "mm")
    return Known(".parquet", stream.getvalue(), dict(zip(titles, columns, strict=True)), {}, units)


def plain_tables() -> st.SearchStrategy[Known]:
    """Draw a table in a format that is read in this process."""
    return st.one_of(text_tables(), json_tables(), parquet_tables())


@st.composite
def foreign_tables(draw: st.DrawFn, folder: Path) -> Known:
    """Draw a table in a format of MATLAB or ASAM, written in a folder first."""
    columns = draw(columns_of_numbers(least=2, most=3))  # one number is no column
    rows, count = len(columns[0]), len(columns)
    data = dict(zip("tuv", columns, strict=False))
    time_s = np.cumsum(draw(st.lists(st.floats(1e-3, 1.0), min_size=rows, max_size=rows)))
    kind = draw(st.sampled_from(["5", "matrix", "capture", "7.3", "mdf"]))
    path = folder / "drawn.mat"
    known: dict[str | int, list[float]] = dict(data)
    if kind == "mdf":
        path = path.with_suffix(".mf4")
        with MDF(version=draw(st.sampled_from(["4.10", "4.20"]))) as file:
            file.append([Signal(np.array(c), time_s, name=n) for n, c in data.items()])
            file.save(path, overwrite=True, compression=draw(st.sampled_from([0, 2])))
        known["time"] = time_s.tolist()
    elif kind == "7.3":
        save_struct_73(path, "s", data)
        known = {f"s.{name}": values for name, values in data.items()}
    else:
        content: Any = dict(data)
        if kind == "matrix":
            content = {"m": np.array(columns).T}
            along = columns if rows >= count else content["m"].tolist()  # the longer side
            named = [f"m(:,{j + 1})" for j in range(len(along))] if count > 1 else ["m"]
            known = dict(zip(named, along, strict=True))
        if kind == "capture":
            channels = [(name, np.array(c), "N", 1) for name, c in data.items()]
            content = {"rec": controldesk([time_s], channels)}
            known["time"] = time_s.tolist()
        savemat(path, content, do_compression=draw(st.booleans()))
    return Known(path.suffix, path.read_bytes(), known)
