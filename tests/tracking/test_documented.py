"""What docs/tracking.md and docs/formats.md say about `tsas track`."""

import json
import re
import tomllib
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tests.commands.documented import documented
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.stages.track import track
from tsas_cli.tracking.settings import Settings

TEXT = (Path(__file__).parents[2] / "docs" / "tracking.md").read_text(encoding="utf-8")


def leaves(content, path=()):
    if isinstance(content, dict):
        return {
            k: v for key, part in content.items() for k, v in leaves(part, (*path, key)).items()
        }
    return {path: content}


def test_the_settings_are_all_there_with_their_defaults():
    shown = leaves(tomllib.loads(re.search("```toml\n(.*?)```", TEXT, re.DOTALL)[1]))
    true = leaves(Settings().model_dump(mode="json", by_alias=True))
    assert set(shown) == set(true)
    for key, value in true.items():
        assert shown[key] == pytest.approx(value, rel=1e-6), key


def test_every_controller_has_its_line():
    table = TEXT.split("## Controllers")[1].split("\n## ")[0]
    lines = tuple(re.findall(r"^\| `([\w-]+)`", table, re.MULTILINE))
    assert lines == CONTROLLERS, "the table of docs/tracking.md has one line for each, in order"


def test_files_and_columns_are_documented(tmp_path):
    (tmp_path / "s.toml").write_text("reference.duration_s = 0.2\nloop.nodes = 5\n")
    track(settings=tmp_path / "s.toml", controllers=CONTROLLERS, out=tmp_path / "out")
    assert set(json.loads((tmp_path / "out" / "tracking.json").read_text())) == documented(
        "tracking.json"
    )
    known = {"time_s", "x_in_mm", "x_out_mm", "f_in_N", "f_out_N"}
    written = {
        name
        for path in (tmp_path / "out" / "runs").iterdir()
        for name in pq.read_schema(path).names
    }
    table = TEXT.split("## What it writes")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
    assert written - known == {name for row in rows for name in re.findall(r"`(\w+)`", row)}
