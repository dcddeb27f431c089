"""A recording that somebody writes to while it is read."""

import os

import pytest

from tests.hostile.case import MAP, TABLE
from tsas_cli.recordings import ingest, run_files
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.ingest import find_files, ingest_files
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import check_unchanged, state_of


def replace(path):
    """Put the same content in its place, as another file."""
    other = path.with_name("other")
    other.write_bytes(path.read_bytes())
    other.replace(path)


def touch(path):
    os.utime(path, ns=(1, 1))


def append(path):
    with path.open("ab") as stream:
        stream.write(b"9,9,9\n")


def after_a_change(monkeypatch, module, name, change):
    """Let a function of a module come after a change."""
    function = getattr(module, name)
    monkeypatch.setattr(module, name, lambda *given: (change(), function(*given))[1])


@pytest.mark.parametrize("change", [replace, touch, append])
def test_any_change_is_seen(tmp_path, change):
    path = tmp_path / "a.csv"
    path.write_text(TABLE)
    before = state_of(path)
    check_unchanged(path, before)
    change(path)
    with pytest.raises(InputError, match="changed while it was read"):
        check_unchanged(path, before)


def test_a_run_that_changes_between_its_checksum_and_its_rows(dataset, monkeypatch):
    path = dataset / "runs" / "a.parquet"
    assert read_dataset(dataset)["a"].time_s.size == 500
    after_a_change(monkeypatch, run_files, "open_parquet", lambda: replace(path))
    with pytest.raises(InputError, match="changed while it was read"):
        _ = read_dataset(dataset)["a"]


def test_a_file_that_changes_while_it_is_ingested(tmp_path, monkeypatch):
    path, mapping, out = tmp_path / "a.csv", tmp_path / "map.toml", tmp_path / "out"
    path.write_text(TABLE)
    mapping.write_text(MAP)
    out.mkdir()
    after_a_change(monkeypatch, ingest, "sha256_of", lambda: append(path))
    with pytest.raises(InputError, match=r"a\.csv: changed while it was read"):
        ingest_files([path], read_map(mapping), mapping, out)
    assert not (out / "dataset.toml").exists()


def test_more_files_than_a_dataset_may_have_are_refused_before_any_is_read(tmp_path, monkeypatch):
    for name in "abcd":
        (tmp_path / f"{name}.csv").write_text("no table")
    monkeypatch.setattr(ingest.limits, "RUNS", 3)
    with pytest.raises(InputError, match="4 files found; expected at most 3"):
        find_files([tmp_path], "*")
    assert len(find_files([tmp_path], "[abc].csv")) == 3
