"""A chain from raw recordings to a page: one byte changed anywhere is found and named."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import tsas_cli as tsas
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import extra_output, write_json
from tsas_cli.support.replacing import SUMS

MAP = """
[dataset]
name = "bench"
[rig]
tendon_diameter_mm = 1.2
tendon_modulus_GPa = 60.0
friction_coefficient = 0.125
load_stiffness_N_per_mm = 1.579
[columns]
time_s = { source = "Time [s]" }
x_in_mm = { source = "In [mm]" }
f_in_N = { source = "Force [N]" }
[run]
sheath_length_mm = 785.4
total_bend_rad = 3.14
preload_N = 25.0
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Ingest, check, simulate twice, the second time with the model of the first, and report."""
    home = tmp_path_factory.mktemp("chain")
    (home / "raw").mkdir(parents=True)
    time_s = np.arange(400) / 200
    x_in_mm = 10 - 10 * np.cos(np.pi * time_s)
    rows = np.column_stack([time_s, x_in_mm, 25 + 2.5 * x_in_mm])
    header = {"header": "Time [s],In [mm],Force [N]", "comments": ""}
    np.savetxt(home / "raw" / "a.csv", rows, delimiter=",", fmt="%.6g", **header)
    (home / "bench.toml").write_text(MAP)
    data = tsas.ingest(home / "raw", map=home / "bench.toml", out=home / "dataset").dataset
    tsas.check(data, out=home / "result" / "check")
    tsas.simulate(data, out=home / "result" / "model")
    tsas.simulate(data, model=home / "result" / "model", out=home / "result" / "simulate")
    folders = [home / "dataset", home / "result" / "check", home / "result" / "simulate"]
    tsas.report(folders, out=home / "result" / "report.html")
    return home


@pytest.fixture(autouse=True)
def chain(made, tmp_path, monkeypatch):
    """Stand in a copy of the chain."""
    shutil.copytree(made, tmp_path / "chain")
    monkeypatch.chdir(tmp_path / "chain")
    return tmp_path / "chain"


FILES = (
    "raw/a.csv",
    "bench.toml",
    "dataset/dataset.toml",
    "dataset/runs/a.parquet",
    "result/check/check.json",
    f"result/check/{SUMS}",
    "result/model/model.toml",
    "result/model/simulation.json",
    "result/model/runs/a.parquet",
    "result/simulate/model.toml",
    "result/simulate/simulation.json",
    "result/simulate/runs/a.parquet",
    f"result/simulate/{SUMS}",
    "result/report.html",
)


def test_an_untouched_chain_fits():
    there = {path.as_posix() for path in Path().rglob("*") if path.is_file()}
    assert there == {*FILES, f"result/model/{SUMS}"}
    result = tsas.verify("result")
    assert {one.state for one in result.files} == {"fits"}
    reported = {one.file for one in result.files}
    assert reported == {file for file in FILES if not file.endswith(SUMS)}
    assert result.wrong == []
    n = len(result.files)
    assert result.tables() == [(f"{n} of {n} recorded checksums fit", (), [])]


@pytest.mark.parametrize("start", ["result", "result/report.html"])
@pytest.mark.parametrize("file", FILES)
def test_one_changed_byte_is_found_and_named(file, start):
    if start == "result/report.html" and file == f"result/check/{SUMS}":
        start = "result"  # of a page's stages what they wrote is looked at, not what else says so
    content = bytearray(Path(file).read_bytes())
    content[len(content) // 2] ^= 1
    Path(file).write_bytes(content)
    wrong = {one.file for one in tsas.verify(start).wrong}
    if file.endswith(SUMS):  # a checksum or a name in it is another one
        assert any(name.startswith(str(Path(file).parent)) for name in wrong)
    else:
        assert file in wrong
    assert wrong <= {file} | {other for other in FILES if file.endswith(SUMS)}


@pytest.mark.parametrize("file", [file for file in FILES if not file.endswith((SUMS, "html"))])
def test_a_missing_file_is_named(file):
    Path(file).unlink()
    wrong = tsas.verify("result").wrong
    assert {(one.file, one.state) for one in wrong} == {(file, "missing")}


def test_raw_recordings_that_have_moved_are_found_where_one_says():
    shutil.move("raw", "archive")
    assert [one.file for one in tsas.verify("result").wrong] == ["raw/a.csv"]
    result = tsas.verify("result", raw="archive")
    assert result.wrong == []
    assert "archive/a.csv" in {one.file for one in result.files}
    Path("archive/a.csv").write_text("something else")
    assert [one.file for one in tsas.verify("result", raw="archive").wrong] == ["raw/a.csv"]
    with pytest.raises(InputError, match="nowhere: is no folder"):
        tsas.verify("result", raw=["archive", "nowhere"])


def test_a_moved_project_fits_as_before(chain, tmp_path):
    shutil.move(chain, tmp_path / "elsewhere")
    os.chdir(tmp_path)
    assert tsas.verify("elsewhere/result").wrong == []


def test_folders_without_their_lists_are_told():
    for sums in Path().rglob(SUMS):
        sums.unlink()
    found = {one.file: one for one in tsas.verify("result/model").files}
    for name in ("simulation.json", "model.toml", "runs/a.parquet"):
        one = found[f"result/model/{name}"]
        assert (one.state, one.why) == ("cannot tell", "no checksum of it is recorded")
    assert found[f"result/model/{SUMS}"].state == "missing"
    assert found["dataset/runs/a.parquet"].state == "fits"


def test_a_file_that_came_later_and_an_emptied_list_are_told():
    Path("result/check/notes.txt").write_text("mine")
    result = tsas.verify("result/check")
    (row,) = result.tables()[0][2]
    assert row[:3] == ("cannot tell", "result/check/notes.txt", f"{SUMS} does not list it")
    assert result.wrong == []
    Path("result/check", SUMS).write_text("")
    (one,) = tsas.verify("result/check").wrong
    assert (one.file, one.state, one.why) == (f"result/check/{SUMS}", "changed", "is empty")


def test_what_a_file_says_is_not_believed():
    content = json.loads(Path("result/check/check.json").read_text())
    for dataset in ({"hashes": {"x": 5}, "folder": 7}, [], {"hashes": []}):
        write_json(Path("result/check/check.json"), content | {"dataset": dataset, "model": "x"})
        wrong = {one.file for one in tsas.verify("result/check").wrong}
        assert wrong == {"result/check/check.json"}
    Path("result/check/check.json").write_text("{")
    assert "is not JSON" in " ".join(one.why for one in tsas.verify("result/check").wrong)
    Path("dataset/dataset.toml").write_text("run = 5\ningest = 7\n")
    assert "dataset/dataset.toml" in {one.file for one in tsas.verify("result").wrong}


@pytest.mark.parametrize("start", ["result", "result/report.html"])
def test_a_page_that_is_cut_or_lacks_its_seal_has_changed(start):
    page = Path("result/report.html")
    whole = page.read_bytes()
    for damaged in (
        whole[: len(whole) // 2],
        whole[:100],
        whole[:-1],
        whole + b"x",
        whole.replace(b"<!-- tsas has read: ", b"<!-- tsas has reae: "),
        whole.replace(b"<!-- sha256 of", b"<!-- sha257 of"),
        whole.replace(b"<!-- a page of", b"<!-- a page off"),
    ):
        page.write_bytes(damaged)
        assert [(one.file, one.state) for one in tsas.verify(start).wrong] == [
            ("result/report.html", "changed")
        ]


def test_of_an_empty_page_nothing_can_be_told():
    Path("result/report.html").write_bytes(b"")
    Path("result/mine.html").write_text("<!DOCTYPE html>\n<p>notes")
    odd = [one for one in tsas.verify("result").files if one.state != "fits"]
    assert [(one.file, one.state) for one in odd] == [("result/report.html", "cannot tell")]
    for page in ("result/report.html", "result/mine.html"):
        with pytest.raises(InputError, match="it records no checksum"):
            tsas.verify(page)


def test_a_list_that_is_a_link_to_another_hides_nothing():
    with Path("result/simulate/runs/a.parquet").open("ab") as file:
        file.write(b"x")
    Path(f"result/simulate/{SUMS}").unlink()
    Path(f"result/simulate/{SUMS}").symlink_to(f"../check/{SUMS}")
    wrong = {(one.file, one.state) for one in tsas.verify("result").wrong}
    assert ("result/simulate/check.json", "missing") in wrong


def test_a_project_is_read_and_fits_behind_a_link(tmp_path):
    (tmp_path / "very" / "deep").mkdir(parents=True)
    Path("linked").symlink_to(tmp_path / "very" / "deep")
    tsas.simulate("dataset", out="linked/simulate")
    for page in ("linked/r.html", "linked/simulate/../r2.html", tmp_path / "very" / "r3.html"):
        tsas.report("linked/simulate", out=page)
        assert tsas.verify(page).wrong == []
    for path in ("linked", tmp_path / "very" / "deep"):
        assert tsas.verify(path).wrong == []
    Path("page.html").symlink_to("linked/r.html")
    assert tsas.verify("page.html").wrong == []


def test_a_name_in_a_list_without_end_is_missing():
    with Path(f"result/check/{SUMS}").open("a") as file:
        file.write(f"{'0' * 64}  {'a' * 5000}\n")
    (one,) = (one for one in tsas.verify("result/check").wrong if "aaa" in one.file)
    assert one.state == "missing"


def test_a_folder_whose_name_is_no_text_cannot_be_told():
    latin = Path(os.fsdecode(b"w\xe9"))
    shutil.copytree("dataset", latin)
    ((state, why),) = {(one.state, one.why) for one in tsas.verify(latin).files}
    assert (state, why) == ("cannot tell", "its name is not UTF-8")


@pytest.mark.parametrize("path", ["nowhere", "raw"])
def test_where_nothing_is_of_tsas_is_one_line(path):
    with pytest.raises(InputError, match=r"does not exist|holds no output of tsas"):
        tsas.verify(path)


def test_what_is_added_to_a_stage_is_in_its_list_and_whole_or_absent():
    def add(folder: Path) -> None:
        (folder / "more").write_text("more")

    with extra_output(add):
        tsas.check("dataset", out="result/more")
    assert tsas.verify("result/more").wrong == []
    assert "result/more/more" in {one.file for one in tsas.verify("result/more").files}

    def fail(folder: Path) -> None:
        raise InputError("does not work", where=folder / "more")

    with pytest.raises(InputError, match=r"result/failed/more: does not work"), extra_output(fail):
        tsas.check("dataset", out="result/failed")
    assert not Path("result/failed").exists()


def test_the_command_prints_and_ends_with_2_where_something_does_not_fit(strict, done):
    assert "recorded checksums fit" in done("verify", "result")
    with Path("raw/a.csv").open("a") as file:
        file.write(" ")
    found = strict("verify", "result", "--json")
    assert (found.returncode, found.stderr.count("\n")) == (2, 1)
    assert "changed or missing: raw/a.csv" in found.stderr
    assert json.loads(found.stdout)["counts"]["changed"] == 1
