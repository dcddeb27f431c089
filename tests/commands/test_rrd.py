"""`--rrd`: a stage's folder holds its stream too, and is else the same."""

import json
import re
from pathlib import Path

from tests.reporting.stream.streams import read

ROOT = Path(__file__).parents[2]
PIPELINES = (ROOT / "pipelines", ROOT / "tsas_cli" / "project" / "make")
WITH_STREAM = {"check", "calibrate", "simulate", "diagnose", "identify-harmonic-drive"}
WITH_STREAM |= {"track", "close-loop"}


def test_a_stage_writes_its_stream_where_it_is_asked_to(done, dataset, tmp_path):
    for name, option in {"with": ["--rrd"], "without": []}.items():
        done("simulate", dataset, "--out", tmp_path / name, *option)
    made, bare = (
        {p.relative_to(tmp_path / name): p for p in (tmp_path / name).rglob("*") if p.is_file()}
        for name in ("with", "without")
    )
    assert {str(path) for path in made.keys() - bare.keys()} == {"stream.rrd"}
    listed = {path for path in bare if path.name != "SHA256SUMS"}
    assert all(made[path].read_bytes() == bare[path].read_bytes() for path in listed)
    found = read(tmp_path / "with" / "stream.rrd")
    assert found["/run/a/f_in_N/measured"].scalars.size == 500
    assert found["/run/a/f_in_N/simulated"].scalars.size == 500


def test_a_second_stream_replaces_the_first(done, dataset, tmp_path):
    out = tmp_path / "checked"
    for _ in range(2):
        printed = done("check", dataset, "--out", out, "--rrd", "--json", "--force")
        assert json.loads(printed)["stage"] == "check"
    assert {path.name for path in out.iterdir()} == {"check.json", "stream.rrd", "SHA256SUMS"}


def test_without_a_folder_there_is_nowhere_to_write(refused, dataset):
    assert "--rrd has no folder to write to; set --out" in refused("check", dataset, "--rrd")


def test_pipelines_write_a_stream_of_every_stage_that_can():
    files = [path for folder in PIPELINES for path in folder.glob("*.mk")]
    files = [path for path in files if path.name != "setup.mk"]  # which compiles kernels alone
    text = "".join(path.read_text(encoding="utf-8") for path in files)
    stages = re.findall(r"^STAGE = (.*)$", text, flags=re.MULTILINE)
    assert stages
    assert all("--rrd" in options for options in stages)
    calls = re.findall(r"tsas\)? ([\w-]+) (.*--out.*)", text, flags=re.IGNORECASE)
    assert {stage for stage, _ in calls} >= WITH_STREAM
    for stage, options in calls:
        assert ("(STAGE)" in options) == (stage in WITH_STREAM), f"{stage} {options}"
