"""What was scored are the recordings that were sealed."""

import json
import shutil

import pytest

from tests.studies.challenge.made import (
    case,
    diagnosis,
    write_entry,
    write_set,
)
from tests.studies.challenge.test_score import scored
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.sums import sums_of


def with_recordings(folder, names):
    """Return a sealed set whose cases hold a recording each, with their checksums."""
    cases = {name: case("backlash") for name in names}
    write_set(folder, cases)
    for name in names:
        dataset = folder / "cases" / name / "dataset"
        (dataset / "runs").mkdir()
        (dataset / "dataset.toml").write_text(f"name = '{name}'", encoding="utf-8")
        (dataset / "runs" / "a.parquet").write_bytes(name.encode())
        cases[name]["sums"] = sums_of(dataset)
    content = {"format": 1, "kind": "challenge-answers", "seed": 17, "cases": cases}
    (folder / "answers.json").write_text(json.dumps(content), encoding="utf-8")
    return folder, cases


@pytest.mark.parametrize("change", ["changed", "missing", "apart"])
def test_a_recording_that_has_changed_is_not_scored(tmp_path, change):
    sealed, _ = with_recordings(tmp_path / "set", ["a"])
    entry = write_entry(tmp_path / "entry", {"a": diagnosis("backlash")})
    file = sealed / "cases/a/dataset/runs/a.parquet"
    if change == "changed":
        file.write_bytes(b"b")
    elif change == "missing":
        file.unlink()
    else:  # the answers are kept by themselves
        shutil.rmtree(sealed / "cases")
        assert scored(sealed, entry)["cases"]["a"]["outcome"] == "exact"
        return
    with pytest.raises(InputError, match=r"a\.parquet: is not the recording that was sealed"):
        scored(sealed, entry)


def test_a_diagnosis_of_other_recordings_is_not_scored(tmp_path):
    sealed, cases = with_recordings(tmp_path / "set", ["a", "b"])
    own, other = (
        diagnosis("backlash", dataset={"name": "case", "hashes": cases[name]["sums"]})
        for name in ("a", "b")
    )
    assert scored(sealed, write_entry(tmp_path / "own", {"a": own}))["cases"]["a"]
    with pytest.raises(InputError, match=r"was made of another dataset\.toml than that of this"):
        scored(sealed, write_entry(tmp_path / "other", {"a": other}))
    silent = diagnosis("backlash", dataset="of another tool")
    assert scored(sealed, write_entry(tmp_path / "silent", {"a": silent}))["cases"]["a"]
