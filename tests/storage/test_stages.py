from pathlib import Path

import pyarrow as pa
import pytest

import tsas_cli as tsas
from tsas_cli.recordings.storage import location_of
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.reporting.stream.stream import shown_stream
from tsas_cli.support.replacing import SUMS


@pytest.fixture
def dataset(tmp_path, manifest, columns) -> Path:
    """Return the folder of a dataset of a few samples, which no stage needs long for."""
    folder = tmp_path / "dataset"
    folder.mkdir()
    few = {name: values[::5] for name, values in columns.items()}
    write_dataset(folder, manifest, {"a": pa.table(few)})
    return folder


@pytest.fixture
def both(dataset, bucket) -> tuple[Path, str]:
    tsas.upload(dataset, f"{bucket}/bench")
    return dataset, f"{bucket}/bench"


def files(folder: Path, address: str, place: str) -> dict[str, bytes]:
    """Return what was written, with the dataset's place in place of its address."""
    return {
        path.relative_to(folder): path.read_bytes().replace(address.encode(), place.encode())
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != SUMS
    }


@pytest.mark.parametrize(
    ("stage", "name"),
    [
        ("check", "check"),
        ("calibrate", "calibration"),
        ("simulate", "simulation"),
        pytest.param("diagnose", "diagnosis", marks=pytest.mark.large),
    ],
)
def test_a_stage_writes_the_same_bytes(both, tmp_path, stage, name):
    local, address = both
    for place, out in ((local, tmp_path / "a"), (address, tmp_path / "b")):
        getattr(tsas, stage)(place, out=out)
    here, there = (files(tmp_path / folder, address, "../dataset") for folder in "ab")
    assert here == there
    assert address.encode() in (tmp_path / "b" / f"{name}.json").read_bytes()


def test_report_and_view_find_the_dataset_again(both, tmp_path):
    local, address = both
    for place, name in ((local, "a"), (address, "b")):
        tsas.simulate(place, out=tmp_path / name / "simulate")
        tsas.report(tmp_path / name / "simulate", out=tmp_path / name / "report.html")
        tsas.report([place, tmp_path / name / "simulate"], out=tmp_path / name / "both.html")
    for page in ("report.html", "both.html"):
        texts = ((tmp_path / name / page).read_text() for name in "ba")
        there, here = (text.partition("<!-- tsas has read")[0] for text in texts)
        assert address in there
        assert there.replace(address, str(local)).replace("/b/", "/a/") == here
    with shown_stream([location_of(address), tmp_path / "b" / "simulate"]) as (stream, notes):
        assert stream.stat().st_size > 0
        assert notes == []


def test_a_report_of_a_dataset_that_has_changed_since_is_refused(both, tmp_path):
    local, address = both
    tsas.check(address, out=tmp_path / "check")
    manifest = local / "dataset.toml"
    manifest.write_text(manifest.read_text() + "# changed\n")
    tsas.upload(local, address, force=True)
    with pytest.raises(tsas.InputError, match="has changed since this stage read it"):
        tsas.report(tmp_path / "check", out=tmp_path / "report.html")


def test_models_are_compared_on_a_dataset_at_an_address(both, tmp_path):
    local, address = both
    tsas.simulate(local, out=tmp_path / "a")
    tsas.simulate(address, out=tmp_path / "b")
    found = tsas.compare(tmp_path / "a", tmp_path / "b")
    assert found.summary["same_recordings"] == "all"
    (row,) = found.summary["errors"]
    assert row["rmse_a"] == row["rmse_b"]
    on = tsas.compare(tmp_path / "a/model.toml", tmp_path / "b/model.toml", on=address)
    assert on.summary["on"]["name"] == "bench-42"
