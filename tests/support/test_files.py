import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.outputs import file_of, folder_of, make_output
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import (
    json_text,
    read_json,
    sha256_of,
    write_json,
)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def make_old(path: Path) -> None:
    make_output(path, result="old")


def test_a_folder_appears_only_when_it_is_complete(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    with folder_of(out) as folder:
        (folder / "result").write_text("new")
        assert not out.exists()
    assert (out / "result").read_text() == "new"
    assert names(out.parent) == ["out"]


def fail_after_writing(path: Path) -> None:
    path.write_text("half")
    raise RuntimeError


def test_an_error_inside_the_block_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), folder_of(tmp_path / "out") as folder:
        fail_after_writing(folder / "half")
    with pytest.raises(RuntimeError), file_of(tmp_path / "page.html") as file:
        fail_after_writing(file)
    assert names(tmp_path) == []


@pytest.mark.parametrize("new", [file_of, folder_of])
@pytest.mark.parametrize("name", [b"z\xff", b"w\xe9/out"])
def test_a_place_whose_name_is_no_text_is_refused(tmp_path: Path, new, name: bytes) -> None:
    out = tmp_path / os.fsdecode(name)
    with pytest.raises(InputError, match=r"its name is not UTF-8; rename it"), new(out):
        pytest.fail("the block must not run")
    assert names(tmp_path) == []


def test_an_existing_folder_stays_as_it_is_without_force(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    with pytest.raises(InputError, match=r"already exists.*--force"), folder_of(tmp_path / "out"):
        pytest.fail("the block must not run")
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["out"]


def test_an_existing_file_stays_as_it_is_without_force(tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text("old")
    with pytest.raises(InputError, match="already exists"), file_of(tmp_path / "page.html"):
        pytest.fail("the block must not run")
    assert (tmp_path / "page.html").read_text() == "old"


def test_a_file_is_not_taken_for_a_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    with pytest.raises(InputError, match="is a file"), folder_of(tmp_path / "file", force=True):
        pytest.fail("the block must not run")
    assert (tmp_path / "file").read_text() == "old"


def test_force_keeps_the_old_output_where_the_new_one_fails(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    with pytest.raises(RuntimeError), folder_of(tmp_path / "out", force=True):
        raise RuntimeError
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["out"]


def test_a_process_killed_inside_the_block_leaves_the_old_output_whole(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    program = """
import os, signal, sys
from pathlib import Path
from tests.outputs import folder_of
with folder_of(Path(sys.argv[1]), force=True) as folder:
    (folder / "result").write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""
    killed = subprocess.run([sys.executable, "-c", program, tmp_path / "out"], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert (tmp_path / "out" / "result").read_text() == "old"


def test_an_empty_folder_may_be_filled(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with folder_of(tmp_path / "out") as folder:
        (folder / "result").write_text("new")
    assert names(tmp_path / "out") == ["result"]


def test_a_folder_is_not_taken_for_a_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder"), file_of(tmp_path, force=True):
        pytest.fail("the block must not run")


@pytest.mark.parametrize("out", [".", ".."])
def test_force_never_removes_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, out: str
) -> None:
    make_old(tmp_path / "work")
    monkeypatch.chdir(tmp_path / "work")
    with (
        pytest.raises(InputError, match="is the current folder"),
        folder_of(Path(out), force=True),
    ):
        pytest.fail("the block must not run")
    assert (tmp_path / "work" / "result").read_text() == "old"


def test_a_dangling_link_counts_as_existing(tmp_path: Path) -> None:
    (tmp_path / "out").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match="already exists"), folder_of(tmp_path / "out"):
        pytest.fail("the block must not run")
    with folder_of(tmp_path / "out", force=True) as folder:
        (folder / "result").write_text("new")
    assert names(tmp_path / "out") == ["result"]


def test_a_place_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file" / "out", tmp_path / ("x" * 300)):
        with pytest.raises(InputError, match="cannot be written"), folder_of(out):
            pytest.fail("the block must not run")
        with pytest.raises(InputError, match="cannot be written"), file_of(out):
            pytest.fail("the block must not run")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_folder_that_may_not_be_read_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "closed").mkdir(mode=0)
    with pytest.raises(InputError, match="cannot be written"), folder_of(tmp_path / "closed"):
        pytest.fail("the block must not run")


def test_json_keeps_numbers_and_turns_what_is_not_finite_into_null(tmp_path: Path) -> None:
    content = {"a": np.float64(0.1), "b": [np.nan, np.inf], 3: np.arange(2), "d": (1, "μ", True)}
    write_json(tmp_path / "x.json", content)
    assert read_json(tmp_path / "x.json") == {
        "a": 0.1,
        "b": [None, None],
        "3": [0, 1],
        "d": [1, "μ", True],
    }
    assert json_text({"μ": 1}) == '{\n  "μ": 1\n}\n'


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", None])
def test_what_is_not_json_is_one_line_with_the_file_name(
    tmp_path: Path, content: bytes | None
) -> None:
    path = tmp_path / "x.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"x\.json: (is not JSON|cannot be read)"):
        read_json(path)


def test_the_checksum_is_the_standard_one(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")  # the example of FIPS 180-4
    assert sha256_of(tmp_path / "abc") == (
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    )
