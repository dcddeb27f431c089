import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tsas_cli.errors import InputError
from tsas_cli.files import (
    json_text,
    new_file,
    new_folder,
    read_json,
    sha256_of,
    write_json,
    write_sums,
)
from tsas_cli.replacing import refuse_input


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def make_old(path: Path) -> None:
    path.mkdir()
    (path / "result").write_text("old")


def test_a_folder_appears_only_when_it_is_complete(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    with new_folder(out) as folder:
        (folder / "result").write_text("new")
        assert not out.exists()
    assert (out / "result").read_text() == "new"
    assert names(out.parent) == ["out"]


def fail_after_writing(path: Path) -> None:
    path.write_text("half")
    raise RuntimeError


def test_an_error_inside_the_block_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), new_folder(tmp_path / "out") as folder:
        fail_after_writing(folder / "half")
    with pytest.raises(RuntimeError), new_file(tmp_path / "page.html") as file:
        fail_after_writing(file)
    assert names(tmp_path) == []


@pytest.mark.parametrize("new", [new_file, new_folder])
@pytest.mark.parametrize("name", [b"z\xff", b"w\xe9/out"])
def test_a_place_whose_name_is_no_text_is_refused(tmp_path: Path, new, name: bytes) -> None:
    out = tmp_path / os.fsdecode(name)
    with pytest.raises(InputError, match=r"its name is no text; rename it"), new(out):
        pytest.fail("the block must not run")
    assert names(tmp_path) == []


def test_an_existing_folder_stays_as_it_is_without_force(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    with pytest.raises(InputError, match=r"already exists.*--force"), new_folder(tmp_path / "out"):
        pytest.fail("the block must not run")
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["out"]


def test_an_existing_file_stays_as_it_is_without_force(tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text("old")
    with pytest.raises(InputError, match="already exists"), new_file(tmp_path / "page.html"):
        pytest.fail("the block must not run")
    assert (tmp_path / "page.html").read_text() == "old"


def test_force_replaces_an_output_and_keeps_nothing_of_the_old_one(tmp_path: Path) -> None:
    out = tmp_path / "out"
    make_old(out)
    (out / "left").write_text("old")
    (out / ".DS_Store").write_text("of a desktop")
    write_sums(out)
    with new_folder(out, force=True) as folder:
        (folder / "result").write_text("new")
        assert names(out) == [".DS_Store", "SHA256SUMS", "left", "result"]
    assert names(out) == ["result"]
    assert (out / "result").read_text() == "new"
    assert names(tmp_path) == ["out"]


def simulate_into(out: Path) -> None:
    with new_folder(out, force=True) as folder:
        (folder / "runs").mkdir()
        (folder / "simulation.json").write_text("{}")


def test_force_never_replaces_recordings_by_what_was_made_of_them(tmp_path: Path) -> None:
    (tmp_path / "dataset" / "runs").mkdir(parents=True)
    (tmp_path / "dataset" / "dataset.toml").write_text("mine")
    told = r"earlier output \(dataset\.toml\); expected a folder with runs, simulation\.json"
    with pytest.raises(InputError, match=told):
        simulate_into(tmp_path / "dataset")
    assert names(tmp_path / "dataset") == ["dataset.toml", "runs"]
    assert names(tmp_path) == ["dataset"]


@pytest.mark.parametrize("more", ["notes.txt", "raw", ".git"])
def test_force_never_deletes_what_no_earlier_output_has_put_there(tmp_path: Path, more) -> None:
    simulate_into(tmp_path / "out")
    simulate_into(tmp_path / "out")
    (tmp_path / "out" / more).mkdir()
    with pytest.raises(InputError, match=f"earlier output \\({re.escape(more)}\\)"):
        simulate_into(tmp_path / "out")
    assert names(tmp_path / "out") == sorted([more, "runs", "simulation.json"])


def test_a_device_or_a_pipe_is_never_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(os.devnull)
    for name in ("pipe", "link"):
        for new in (new_folder, new_file):
            with pytest.raises(InputError, match="is a device or a pipe"):
                stack_of(new(tmp_path / name, force=True))
    assert (tmp_path / "pipe").is_fifo()
    assert (tmp_path / "link").is_symlink()


def stack_of(block) -> None:
    with block:
        pytest.fail("the block must not run")


def test_what_is_read_is_not_written(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    refuse_input(tmp_path / "a", [tmp_path / "b", tmp_path / "a.csv"])
    (tmp_path / "link").symlink_to(tmp_path / "a")
    for out in ("a", "link", "a/b.csv"):
        with pytest.raises(InputError, match="is read, and would be replaced"):
            refuse_input(tmp_path / out, [tmp_path / "a" / "b.csv"])


def test_a_file_is_not_taken_for_a_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    with pytest.raises(InputError, match="is a file"), new_folder(tmp_path / "file", force=True):
        pytest.fail("the block must not run")
    assert (tmp_path / "file").read_text() == "old"


def test_force_keeps_the_old_output_where_the_new_one_fails(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    with pytest.raises(RuntimeError), new_folder(tmp_path / "out", force=True):
        raise RuntimeError
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["out"]


def test_a_process_killed_inside_the_block_leaves_the_old_output_whole(tmp_path: Path) -> None:
    make_old(tmp_path / "out")
    program = """
import os, signal, sys
from pathlib import Path
from tsas_cli.files import new_folder
with new_folder(Path(sys.argv[1]), force=True) as folder:
    (folder / "result").write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""
    killed = subprocess.run([sys.executable, "-c", program, tmp_path / "out"], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert (tmp_path / "out" / "result").read_text() == "old"


def test_an_empty_folder_may_be_filled(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with new_folder(tmp_path / "out") as folder:
        (folder / "result").write_text("new")
    assert names(tmp_path / "out") == ["result"]


def test_a_folder_is_not_taken_for_a_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder"), new_file(tmp_path, force=True):
        pytest.fail("the block must not run")


@pytest.mark.parametrize("out", [".", ".."])
def test_force_never_removes_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, out: str
) -> None:
    make_old(tmp_path / "work")
    monkeypatch.chdir(tmp_path / "work")
    with (
        pytest.raises(InputError, match="is the current folder"),
        new_folder(Path(out), force=True),
    ):
        pytest.fail("the block must not run")
    assert (tmp_path / "work" / "result").read_text() == "old"


def test_a_dangling_link_counts_as_existing(tmp_path: Path) -> None:
    (tmp_path / "out").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match="already exists"), new_folder(tmp_path / "out"):
        pytest.fail("the block must not run")
    with new_folder(tmp_path / "out", force=True) as folder:
        (folder / "result").write_text("new")
    assert names(tmp_path / "out") == ["result"]


def test_a_place_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file" / "out", tmp_path / ("x" * 300)):
        with pytest.raises(InputError, match="cannot be written"), new_folder(out):
            pytest.fail("the block must not run")
        with pytest.raises(InputError, match="cannot be written"), new_file(out):
            pytest.fail("the block must not run")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_folder_that_may_not_be_read_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "closed").mkdir(mode=0)
    with pytest.raises(InputError, match="cannot be written"), new_folder(tmp_path / "closed"):
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
