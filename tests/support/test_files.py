import os
from pathlib import Path

import numpy as np
import pytest

from tests.outputs import file_of, folder_of, make_output, names, refused, write
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import json_text, read_json, sha256_of, write_json


def test_a_folder_appears_only_when_it_is_complete(tmp_path):
    out = tmp_path / "deep" / "out"
    with folder_of(out) as folder:
        (folder / "result").write_text("new")
        assert not out.exists()
    assert (out / "result").read_text() == "new"
    assert names(out.parent) == ["out"]


def fail_after_writing(path):
    path.write_text("half")
    raise RuntimeError


def test_an_error_inside_the_block_leaves_nothing(tmp_path):
    with pytest.raises(RuntimeError), folder_of(tmp_path / "out") as folder:
        fail_after_writing(folder / "half")
    with pytest.raises(RuntimeError), file_of(tmp_path / "page.html") as file:
        fail_after_writing(file)
    assert names(tmp_path) == []


@pytest.mark.parametrize("new", [file_of, folder_of])
@pytest.mark.parametrize("name", [b"z\xff", b"w\xe9/out"])
def test_a_place_whose_name_is_no_text_is_refused(tmp_path, new, name):
    refused(new(tmp_path / os.fsdecode(name)), r"its name is not UTF-8; rename it")
    assert names(tmp_path) == []


@pytest.mark.parametrize("new", [file_of, folder_of])
def test_an_error_leaves_no_folder_above_the_output_but_those_that_were_there(tmp_path, new):
    (tmp_path / "there").mkdir()
    with pytest.raises(RuntimeError), new(tmp_path / "there" / "a" / "b" / "c") as path:
        fail_after_writing(path if new is file_of else path / "half")
    assert list(tmp_path.rglob("*")) == [tmp_path / "there"]


def test_what_exists_stays_as_it_is_without_force(tmp_path):
    make_output(tmp_path / "out", result="old")
    refused(folder_of(tmp_path / "out"), r"already exists.*--force")
    assert (tmp_path / "out" / "result").read_text() == "old"
    (tmp_path / "page.html").write_text("old")
    refused(file_of(tmp_path / "page.html"), "already exists")
    assert (tmp_path / "page.html").read_text() == "old"
    assert names(tmp_path) == ["out", "page.html"]


def test_a_file_is_not_taken_for_a_folder_nor_a_folder_for_a_file(tmp_path):
    (tmp_path / "file").write_text("old")
    refused(folder_of(tmp_path / "file", force=True), "is a file")
    assert (tmp_path / "file").read_text() == "old"
    refused(file_of(tmp_path, force=True), "is a folder")


def test_force_keeps_the_old_output_where_the_new_one_fails(tmp_path):
    make_output(tmp_path / "out", result="old")
    with pytest.raises(RuntimeError), folder_of(tmp_path / "out", force=True):
        raise RuntimeError
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["out"]


def test_an_empty_folder_may_be_filled(tmp_path):
    (tmp_path / "out").mkdir()
    write(tmp_path / "out")
    assert names(tmp_path / "out") == ["result"]


@pytest.mark.parametrize("out", [".", ".."])
def test_force_never_removes_the_current_folder(tmp_path, monkeypatch, out):
    make_output(tmp_path / "work", result="old")
    monkeypatch.chdir(tmp_path / "work")
    refused(folder_of(Path(out), force=True), "is the current folder")
    assert (tmp_path / "work" / "result").read_text() == "old"


def test_a_dangling_link_counts_as_existing(tmp_path):
    (tmp_path / "out").symlink_to(tmp_path / "nowhere")
    refused(folder_of(tmp_path / "out"), "already exists")
    write(tmp_path / "out", force=True)
    assert names(tmp_path / "out") == ["result"]


@pytest.mark.parametrize("new", [file_of, folder_of])
@pytest.mark.parametrize("out", ["file/out", "x" * 300])
def test_a_place_that_cannot_be_written_is_one_line(tmp_path, new, out):
    (tmp_path / "file").write_text("")
    refused(new(tmp_path / out), "cannot be written")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_folder_that_may_not_be_read_is_one_line(tmp_path):
    (tmp_path / "closed").mkdir(mode=0)
    refused(folder_of(tmp_path / "closed"), "cannot be written")


def test_json_keeps_numbers_and_turns_what_is_not_finite_into_null(tmp_path):
    content = {"a": np.float64(0.1), "b": [np.nan, np.inf], 3: np.arange(2), "d": (1, "μ", True)}
    write_json(tmp_path / "x.json", content)
    plain = {"a": 0.1, "b": [None, None], "3": [0, 1], "d": [1, "μ", True]}
    assert read_json(tmp_path / "x.json") == plain
    assert json_text({"μ": 1}) == '{\n  "μ": 1\n}\n'


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", None])
def test_what_is_not_json_is_one_line_with_the_file_name(tmp_path, content):
    path = tmp_path / "x.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"x\.json: (is not JSON|cannot be read)"):
        read_json(path)


def test_the_checksum_is_the_standard_one(tmp_path):
    (tmp_path / "abc").write_bytes(b"abc")  # the example of FIPS 180-4
    assert sha256_of(tmp_path / "abc") == (
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    )


@pytest.mark.parametrize("umask", [0o022, 0o077, 0o027])
def test_an_output_and_what_is_in_it_have_the_mode_that_the_umask_leaves(tmp_path, umask):
    before = os.umask(umask)
    try:
        with folder_of(tmp_path / "out") as folder:
            (folder / "result").write_text("new")
        with file_of(tmp_path / "page.html") as file:
            file.write_text("new")
    finally:
        os.umask(before)
    modes = {name: (tmp_path / name).stat().st_mode & 0o777 for name in ("out", "page.html")}
    assert modes == {"out": 0o777 & ~umask, "page.html": 0o666 & ~umask}
