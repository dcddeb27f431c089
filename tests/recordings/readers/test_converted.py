"""Packed files, which are converted before they are read; lines of JSON."""

import bz2
import gzip
import json
import lzma
import zipfile
from pathlib import Path

import pytest

from tests.refusals import refusal
from tsas_cli.recordings.ingest import find_files
from tsas_cli.recordings.readers import is_known, names, read, stem, tables
from tsas_cli.recordings.readers.converted import _made
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

TEXT = b"t,f\n0,1\n0.5,2\n"


def zipped(path, **members):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


@pytest.fixture
def write(tmp_path):
    def call(name, content=TEXT):
        path = tmp_path / name
        if path.suffix == ".zip":
            zipped(path, **{"run/a.csv": content, "__MACOSX/a.csv": b"x", "readme.md": b"y"})
        else:
            pack = {".gz": gzip.compress, ".bz2": bz2.compress, ".xz": lzma.compress}
            path.write_bytes(pack.get(path.suffix, bytes)(content))
        return path

    return call


@pytest.mark.parametrize("name", ["a.csv.gz", "a.CSV.bz2", "a.csv.xz", "a.csv.zip", "a.zip"])
def test_packed_files_are_read(write, name):
    assert read(write(name), ReadOptions(), ["t", "f"]).columns["f"].tolist() == [1, 2]


@pytest.mark.parametrize("name", ["a.jsonl", "a.ndjson", "a.jsonl.gz"])
def test_lines_of_json_are_read(write, name):
    records = [{"t": i, "force": {"x": i / 2, "all": [i, 2]}} for i in range(3)]
    path = write(name, "\n\n".join(map(json.dumps, records)).encode())
    columns = read(path, ReadOptions(), ["t", "force.x", "force.all[0]"]).columns
    assert columns["force.x"].tolist() == [0, 0.5, 1]
    assert columns["force.all[0]"].tolist() == [0, 1, 2]


def test_an_archive_may_hold_lines_of_json(tmp_path):
    path = zipped(tmp_path / "a.zip", **{"a.jsonl": b'{"t": 0}\n{"t": 1}\n'})
    assert names(path, ReadOptions()) == ("t",)


def test_tables_of_a_packed_file_are_found(write):
    path = write("a.json.gz", json.dumps({"log": {"t": [0, 1], "x": [1, 2]}}).encode())
    assert tables(path) == ["log"]


def test_errors_name_the_file_itself(write):
    path = write("a.csv.gz", b"t,f\n0,1\n0.5,x\n")
    with pytest.raises(InputError, match=r"a\.csv\.gz, row 3: column f holds 'x'"):
        read(path, ReadOptions(), ["f"])


def test_zeros_that_fill_the_disk_are_refused(write, monkeypatch):
    monkeypatch.setattr(limits, "HARMLESS", 1 << 20)
    with pytest.raises(InputError, match="at most 500 times its size"):
        names(write("a.csv.gz", bytes(3 << 20)), ReadOptions())


def test_an_archive_of_several_files_is_refused(tmp_path):
    path = zipped(tmp_path / "my runs.zip", **{"a.csv": TEXT, "b.csv": TEXT})
    with pytest.raises(InputError, match=r"unzip '.*my runs\.zip' -d '.*my runs'"):
        names(path, ReadOptions())


def test_of_a_name_in_an_archive_the_suffix_alone_counts(tmp_path):
    (tmp_path / "in" / "deep").mkdir(parents=True)
    path = zipped(tmp_path / "in" / "deep" / "a.zip", **{"../../escaped.csv": TEXT})
    assert names(path, ReadOptions()) == ("t", "f")
    assert not list(tmp_path.rglob("escaped.csv"))


def test_a_changed_file_is_unpacked_again(write):
    assert names(write("a.csv.gz"), ReadOptions()) == ("t", "f")
    assert names(write("a.csv.gz", b"t,x\n0,1\n0.5,2\n"), ReadOptions()) == ("t", "x")


def test_few_temporary_files_are_kept(write):
    for i in range(5):
        names(write(f"{i}.csv.gz"), ReadOptions())
    assert len(_made) == 3
    assert all(path.exists() for path in _made.values())


def test_a_folder_holds_what_its_names_say(write, tmp_path):
    for name in ("a.csv.gz", "b.csv", "c.tar.gz", "d.gz", "e.zip", "f.csv.zip", "g.jsonl"):
        write(name)
    found = [path.name for path in find_files([tmp_path], "*")]
    assert found == ["a.csv.gz", "b.csv", "f.csv.zip", "g.jsonl"]
    assert not is_known(tmp_path / "a.csv.gz.gz")


def test_the_run_is_named_after_what_is_packed(tmp_path):
    assert [stem(tmp_path / n) for n in ("a.csv", "a.csv.gz", "a.zip")] == ["a", "a", "a"]


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("a b.tar.gz", "mkdir -p 'a b' && tar -xf 'a b.tar.gz' -C 'a b'"),
        ("a.pkl", 'pandas.read_pickle(sys.argv[1]).to_parquet(sys.argv[2])" a.pkl a.parquet'),
        ("a.nc", "cp a.nc a.h5"),
        ("a.docx", "export it from the program"),
    ],
)
def test_what_stays_unread_says_how_to_convert_it(tmp_path, monkeypatch, name, command):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_bytes(b"x")
    assert command in refusal(names, Path(name), ReadOptions())
