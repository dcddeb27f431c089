"""Names that a spreadsheet would compute stay text, and no command writes a table for one."""

import re
from pathlib import Path

import pyarrow.parquet as pq

import tsas_cli as tsas
from tests.hostile.case import MAP, columns

FORMULA = "=cmd|' C calc'!A0"  # a run's id cannot hold a slash
PACKAGE = Path(tsas.__file__).parent


def test_a_formula_stays_the_text_that_it_is(tmp_path):
    (tmp_path / "in").mkdir()
    values = zip(*columns().values(), strict=True)
    rows = "".join(f"{t},{x},{f},1\n" for t, x, f in values)
    (tmp_path / "in" / f"{FORMULA}.csv").write_text(f't,x,f,"{FORMULA}"\n{rows}')
    mapping = tmp_path / "map.toml"
    mapping.write_text(f"{MAP}[read]\nextra = ['''{FORMULA}''']\n")
    made = tmp_path / "made"
    tsas.ingest(tmp_path / "in", map=mapping, out=made / "data")
    tsas.check(made / "data", out=made / "check")
    tsas.report([made / "data", made / "check"], out=made / "page.html")
    path = made / "data" / "runs" / f"{FORMULA}.parquet"
    assert pq.read_schema(path).names[-1] == FORMULA
    assert "=cmd|&#39; C calc&#39;!A0" in (made / "page.html").read_text(encoding="utf-8")
    suffixes = {file.suffix for file in made.rglob("*") if file.is_file()}
    assert suffixes == {"", ".toml", ".parquet", ".json", ".html"}  # "" is SHA256SUMS


def test_nothing_writes_what_a_spreadsheet_opens():
    writers = re.compile(r"csv\.(writer|DictWriter|write_csv)|\.to_(csv|excel|clipboard)|savetxt")
    sources = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert len(sources) > 300
    export = PACKAGE / "stages" / "export.py"  # where ids of runs are no formulas
    assert [path for path, text in sources.items() if writers.search(text)] == [export]
