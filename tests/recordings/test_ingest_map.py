import re
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.refusals import refusal
from tsas_cli import ingest
from tsas_cli.recordings.ingest_map import ColumnMap, read_map
from tsas_cli.recordings.readers import delimited, parquet
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.recordings.writing import write_parquet

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "docs" / "ingest.md").read_text(encoding="utf-8")

WHOLE = """
[dataset]
name = "m"
[columns.time_s]
source = 1
[columns.x_in_mm]
source = "x"
[columns.f_in_N]
source = "f"
"""


@pytest.fixture
def ask(tmp_path):
    def call(text):
        path = tmp_path / "map.toml"
        path.write_text(text)
        return read_map(path)

    return call


def test_the_smallest_map_and_the_columns_it_takes(ask):
    mapping = ask(WHOLE + '[columns.temperature_C]\nsource = "f"\n[read]\nextra = ["note", "x"]\n')
    assert mapping.sources() == [1, "x", "f", "note"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (WHOLE.replace("f_in_N", "f_in_n"), "unknown column f_in_n (did you mean f_in_N?)"),
        (WHOLE + "ofset = 1\n", "columns.f_in_N.ofset (did you mean offset?)"),
        (WHOLE + "[reed]\n", "unknown key reed (did you mean read?)"),
        (WHOLE + "[read]\ndecimals = ','\n", "read.decimals (did you mean decimal?)"),
        (WHOLE + "[rig]\ntendon_diameter = 1\n", "did you mean tendon_diameter_mm?"),
        (WHOLE + "[run]\npreload = 1\n", "did you mean preload_N?"),
        (WHOLE + "[run]\nload = 'sprung'\n", "run.load"),
        (WHOLE + "[run.from_header]\npattern = '('\n", "run.from_header.pattern"),
        (WHOLE + "sign = 2\n", "columns.f_in_N.sign"),
        (WHOLE + "factor = 2\n", "factor and factor_unit belong together"),
        (WHOLE + "rate_Hz = 2\n", "columns.f_in_N: has a source and rate_Hz: only one of them"),
        (WHOLE.replace('source = "f"', ""), "columns.f_in_N: needs a source"),
        (
            WHOLE + '[run.conditions.total_bend_rad]\ngroup = "bend"\nunit = "deg"\n',
            "unknown key run.conditions.total_bend_rad.group (known are from, unit)",
        ),
        (WHOLE.replace('source = "f"', "rate_Hz = 2"), "f_in_N cannot have rate_Hz"),
        (WHOLE.replace("[columns.time_s]", "[columns.x_out_mm]"), "time_s is missing"),
        (WHOLE.replace("x_in_mm", "temperature_C"), "an input and an output column"),
        (
            WHOLE + '[columns.f_out_N]\nsource = "f"\n',
            "columns: f_in_N and f_out_N have one source, 'f'",
        ),
        (WHOLE.replace('name = "m"', ""), "dataset.name is missing"),
        (WHOLE + "offset = true\n", "columns.f_in_N.offset: true and false are no numbers"),
        (WHOLE + "sign = true\n", "columns.f_in_N.sign: true and false are no numbers"),
        (WHOLE.replace("source = 1", "rate_Hz = true"), "columns.time_s.rate_Hz: true and false"),
        (WHOLE.replace("source = 1", "source = true"), "columns.time_s.source: true and false"),
        (WHOLE + "[read]\nextra = ['a', true]\n", "read.extra.1: true and false are no numbers"),
        (
            WHOLE + "offset = 'last'\n",
            "map.toml: columns.f_in_N.offset: input should be a number or 'first', got 'last'",
        ),
        (WHOLE + "offset = nan\n", "offset: input should be a finite number or 'first', got nan"),
        (WHOLE.replace('"m"', "2026-01-01"), "name: input should be text, got 2026-01-01"),
        (WHOLE + "[read]\nextra = 5\n", "read.extra: input should be a list, got 5"),
        (WHOLE.replace("1\n", "1.5\n"), "source: input should be text or a whole number, got 1.5"),
        ("[dataset", "is not TOML"),
    ],
)
def test_what_is_wrong_is_reported_with_the_nearest_known_word(ask, text, message):
    line = refusal(ask, text)
    assert message in line
    assert "map.toml" in line


def test_a_missing_map_is_reported(tmp_path):
    assert "cannot be read" in refusal(read_map, tmp_path / "none.toml")


@pytest.mark.parametrize("path", sorted((REPOSITORY / "datasets" / "maps").glob("*.toml")))
def test_the_shipped_maps_are_maps(path):
    assert read_map(path).dataset.name == path.stem


def test_the_page_shows_a_map_that_works_and_names_every_key(ask):
    *_, example = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    assert ask(example).columns["x_in_mm"].sign == -1
    for key in [*ReadOptions.model_fields, *ColumnMap.model_fields]:
        assert f"`{key}`" in PAGE


ROWS = 1000
MAP = """
[dataset]
name = "parts"
[read]
drop_repeated_rows = {drop}
extra = ["note"]
[columns.time_s]
{clock}
[columns.x_in_mm]
source = "x"
unit = "in"
sign = -1
offset = "first"
[columns.f_in_N]
source = "f"
unit = "N"
offset = 2.0
"""


@pytest.fixture
def parts(monkeypatch):
    """Return a function that lets files be read in parts of so many rows."""

    def set_rows(rows):
        for module in (delimited, parquet):
            monkeypatch.setattr(module, "BATCH_ROWS", rows)

    return set_rows


def lines(*, repeats=True):
    """Return rows as text; the first displacements are empty, some rows repeat."""
    rng = np.random.default_rng(1)
    rows = []
    for i in range(ROWS):
        place = "" if i < 230 else f"{np.sin(i / 40):.6f}"
        rows.append(f"{i},{place},{rng.normal():.5f},{i % 7}\n")
        if repeats and i % 97 == 50:
            rows.append(rows[-1])
    return rows


def made(folder, name, text, *, clock='source = "t"\nunit = "ms"', drop="true"):
    folder.mkdir(exist_ok=True)
    (folder / "map.toml").write_text(MAP.format(clock=clock, drop=drop))
    (folder / "a.csv").write_text("t,x,f,note\n" + "".join(text))
    ingest(folder / "a.csv", map=folder / "map.toml", out=folder / name)
    return pq.read_table(folder / name / "runs" / "a.parquet")


@pytest.mark.parametrize("rows", [1, 7, 100, 513])
@pytest.mark.parametrize("clock", ['source = "t"\nunit = "ms"', "rate_Hz = 500.0"])
def test_parts_give_what_the_whole_gives(tmp_path, parts, rows, clock):
    drop = "true" if "source" in clock else "false"
    whole = made(tmp_path, "whole", lines(), clock=clock, drop=drop)
    parts(max(rows, 2))  # one row alone is no recording
    assert made(tmp_path, "parts", lines(), clock=clock, drop=drop).equals(whole)
    assert whole.column("x_in_mm").null_count >= 230
    assert whole.num_rows == (ROWS if drop == "true" else len(lines()))


def test_parts_of_parquet_give_what_the_whole_gives(tmp_path, parts):
    whole = made(tmp_path, "whole", lines())
    source = tmp_path / "b.parquet"
    write_parquet(source, whole.rename_columns(["t", "x", "f", "note"]))
    for name, rows in (("one", 10_000), ("parts", 130)):
        parts(rows)
        ingest(source, map=tmp_path / "map.toml", out=tmp_path / name)
    one, some = (pq.read_table(tmp_path / n / "runs" / "b.parquet") for n in ("one", "parts"))
    assert one.num_rows == ROWS
    assert some.equals(one)


def test_a_comment_far_down_is_left_out_as_one_at_the_top_is(tmp_path, parts):
    text = lines()
    whole = made(tmp_path, "whole", text)
    parts(100)
    assert made(tmp_path, "parts", [*text[:700], "# a stop\n", *text[700:]]).equals(whole)


@pytest.mark.parametrize(
    ("at", "line", "message"),
    [
        (600, "5,0,0,0\n", "row 602: the time does not increase (0.599 s, then 0.005 s)"),
        (640, "x,0,0,0\n", "row 642: column t holds 'x'; expected a number"),
        (500, ",0,0,0\n", "row 502: the time is empty"),
    ],
)
def test_a_fault_far_down_is_reported_with_its_row(tmp_path, parts, at, line, message):
    parts(100)
    text = lines(repeats=False)
    assert message in refusal(made, tmp_path, "a", [*text[:at], line, *text[at:]], drop="false")


def test_time_that_stands_between_two_parts_is_seen(tmp_path, parts):
    parts(100)
    text = [f"{i - (i >= 100)},0,0,0\n" for i in range(300)]
    line = refusal(made, tmp_path, "a", text, drop="false")
    assert "row 102: the time does not increase" in line


def test_rows_that_are_all_the_same_are_no_recording(tmp_path):
    assert "all rows are identical" in refusal(made, tmp_path, "a", ["1,2,3,4\n"] * 5)
