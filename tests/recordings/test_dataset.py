import copy
import hashlib
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.errors import InputError

Columns = dict[str, np.ndarray]


def put(folder: Path, table: pa.Table) -> None:
    """Replace run `a` by a table, with the right checksum."""
    pq.write_table(table, folder / "runs" / "a.parquet")
    rehash(folder)


def rehash(folder: Path) -> None:
    digest = hashlib.sha256((folder / "runs" / "a.parquet").read_bytes()).hexdigest()
    old = read_dataset(folder).manifest.run[0].sha256
    text = (folder / "dataset.toml").read_text()
    (folder / "dataset.toml").write_text(text.replace(old, digest))


def only(folder: Path) -> Recording:
    (recording,) = read_dataset(folder)
    return recording


def refusal(folder: Path) -> str:
    with pytest.raises(InputError) as caught:
        only(folder)
    return caught.value.line().removeprefix(str(folder / "runs" / "a.parquet"))


def test_what_is_written_is_read_to_the_last_bit(dataset: Path, columns: Columns) -> None:
    recording = only(dataset)
    assert set(recording.columns) == set(columns)
    for name, values in columns.items():
        np.testing.assert_array_equal(recording.columns[name], values)
    assert recording.time_s is recording.columns["time_s"]
    assert recording.get("f_out_N") is None
    assert recording.run.preload_N == 25.0


def test_each_known_column_carries_its_unit_in_the_file(dataset: Path) -> None:
    schema = pq.read_schema(dataset / "runs" / "a.parquet")
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert units == {"time_s": "s", "x_in_mm": "mm", "f_in_N": "N"}


def test_the_hashes_are_those_of_the_files(dataset: Path) -> None:
    expected = {
        name: hashlib.sha256((dataset / name).read_bytes()).hexdigest()
        for name in ("dataset.toml", "runs/a.parquet")
    }
    assert read_dataset(dataset).hashes() == expected


def test_unknown_columns_travel_along_untouched(
    tmp_path: Path, manifest: Manifest, columns: Columns
) -> None:
    note = pa.array(["μ"] * 499 + [None])
    write_out = tmp_path / "out"
    write_out.mkdir()
    write_dataset(write_out, manifest, {"a": pa.table(columns | {"note": note})})
    assert pq.read_table(write_out / "runs" / "a.parquet")["note"].combine_chunks() == note
    assert "note" not in only(write_out).columns


def test_a_gap_is_null_in_the_file_and_nan_in_memory(dataset: Path, columns: Columns) -> None:
    force = pa.array(columns["f_in_N"], mask=np.arange(500) == 7)
    put(dataset, pa.table(columns | {"f_in_N": force}))
    assert np.flatnonzero(np.isnan(only(dataset).columns["f_in_N"])).tolist() == [7]


@pytest.mark.parametrize("kind", ["float32", "int64", "uint8"])
def test_other_kinds_of_numbers_are_accepted(dataset: Path, columns: Columns, kind: str) -> None:
    force = columns["f_in_N"].astype(kind)
    put(dataset, pa.table(columns | {"f_in_N": force}))
    read = only(dataset).columns["f_in_N"]
    assert read.dtype == np.float64
    np.testing.assert_array_equal(read, force.astype(float))


def test_integers_beyond_the_exact_floats_are_accepted(dataset: Path, columns: Columns) -> None:
    nanoseconds = 2**60 + np.arange(500) * 1_000_000
    put(dataset, pa.table(columns | {"time_s": nanoseconds}))
    assert only(dataset).time_s[-1] == pytest.approx(nanoseconds[-1])


def test_a_dataset_made_by_pandas_alone_works(tmp_path: Path, columns: Columns) -> None:
    frame = pd.DataFrame(columns).assign(f_out_N=lambda t: t.f_in_N.where(t.index != 3))
    frame.to_parquet(tmp_path / "first run.parquet")
    digest = hashlib.sha256((tmp_path / "first run.parquet").read_bytes()).hexdigest()
    (tmp_path / "dataset.toml").write_text(
        'format = 1\nname = "mine"\nkind = "measured"\n'
        f'[[run]]\nid = "1"\nfile = "first run.parquet"\nsha256 = "{digest.upper()}"\n'
    )
    recording = only(tmp_path)
    np.testing.assert_array_equal(recording.columns["x_in_mm"], columns["x_in_mm"])
    assert np.isnan(recording.columns["f_out_N"]).sum() == 1


def test_a_changed_file_is_found_by_its_checksum(dataset: Path, columns: Columns) -> None:
    pq.write_table(pa.table(columns | {"f_in_N": columns["x_in_mm"]}), dataset / "runs/a.parquet")
    assert refusal(dataset).startswith(": the checksum differs from the manifest's; expected ")


@pytest.mark.parametrize("size", [0, 3, 8, 2000, -1])
def test_a_truncated_file_is_one_line(dataset: Path, size: int) -> None:
    path = dataset / "runs" / "a.parquet"
    path.write_bytes(path.read_bytes()[:size])
    assert "checksum" in refusal(dataset)
    rehash(dataset)
    assert refusal(dataset).startswith(": cannot be read as Parquet (")


def test_a_damaged_column_name_is_one_line(dataset: Path) -> None:
    path = dataset / "runs" / "a.parquet"
    path.write_bytes(path.read_bytes().replace(b"x_in_mm", b"x_in_m\xff"))
    rehash(dataset)
    assert refusal(dataset).startswith(": cannot be read as Parquet (")


def test_a_missing_file_is_one_line(dataset: Path) -> None:
    (dataset / "runs" / "a.parquet").unlink()
    assert refusal(dataset).startswith(": the run's file is missing")


def test_a_folder_in_the_place_of_a_file_is_one_line(dataset: Path) -> None:
    text = (dataset / "dataset.toml").read_text()
    (dataset / "dataset.toml").write_text(text.replace("runs/a.parquet", "."))
    with pytest.raises(InputError, match="the run's file is missing"):
        only(dataset)


def test_a_link_out_of_the_folder_is_refused(dataset: Path, tmp_path: Path) -> None:
    path = dataset / "runs" / "a.parquet"
    path.rename(tmp_path / "elsewhere.parquet")
    path.symlink_to(tmp_path / "elsewhere.parquet")
    assert refusal(dataset) == ": a link leads out of the dataset's folder"


def test_a_missing_time_lists_the_columns_that_are_there(dataset: Path, columns: Columns) -> None:
    del columns["time_s"]
    put(dataset, pa.table(columns | {"Time [ms]": np.arange(500)}))
    line = refusal(dataset)
    assert line.startswith(": column time_s is missing")
    assert line.endswith("there are: x_in_mm, f_in_N, Time [ms]")


@pytest.mark.parametrize("kept", [{"x_in_mm"}, {"f_in_N"}, set()])
def test_an_input_and_another_output_are_needed(
    dataset: Path, columns: Columns, kept: set[str]
) -> None:
    put(dataset, pa.table({n: v for n, v in columns.items() if n in kept | {"time_s"}}))
    assert refusal(dataset).startswith(": an input and an output column are needed")


@pytest.mark.parametrize("rows", [0, 1])
def test_too_few_rows_are_refused(dataset: Path, columns: Columns, rows: int) -> None:
    put(dataset, pa.table(columns).slice(0, rows))
    assert refusal(dataset) == f": {rows} rows; expected at least two samples"


@pytest.mark.parametrize("values", [["5 N"] * 500, [True] * 500])
def test_what_is_not_a_number_is_refused(
    dataset: Path, columns: Columns, values: list[object]
) -> None:
    put(dataset, pa.table(columns | {"f_in_N": values}))
    assert refusal(dataset).startswith(": column f_in_N holds ")


def test_an_infinite_value_is_named_with_its_row(dataset: Path, columns: Columns) -> None:
    columns["f_in_N"][12] = np.inf
    put(dataset, pa.table(columns))
    assert refusal(dataset).startswith(", row 12: f_in_N is infinite")


@pytest.mark.parametrize(
    ("column", "value", "most"),
    [
        ("x_in_mm", 3.4e38, "1e+06 mm"),
        ("x_in_mm", -1.1e6, "1e+06 mm"),
        ("f_in_N", 1e10, "1e+09 N"),
    ],
)
def test_a_value_that_no_rig_has_is_named_with_its_row(
    dataset: Path, columns: Columns, column: str, value: float, most: str
) -> None:
    columns[column][12] = value
    put(dataset, pa.table(columns))
    message = refusal(dataset)
    assert message.startswith(
        f", row 12: {column} is {value:g}; expected a magnitude of at most {most}"
    )
    entry = read_dataset(dataset).runs[0]
    assert read_recording(dataset, entry, strict=False).columns[column][12] == value


@pytest.mark.parametrize("scale", [1e-100, 1e100])
def test_time_in_steps_that_no_clock_has_is_named_with_its_row(
    dataset: Path, columns: Columns, scale: float
) -> None:
    put(dataset, pa.table(columns | {"time_s": scale * columns["time_s"]}))
    assert refusal(dataset).startswith(", row 1: time_s increases by ")


def test_one_step_that_no_clock_has_is_named_with_its_row(dataset: Path, columns: Columns) -> None:
    columns["time_s"][:2] = 0.0, 5e-324
    put(dataset, pa.table(columns))
    assert refusal(dataset).startswith(
        ", row 1: time_s increases by 4.94066e-324 s; expected steps"
    )


@pytest.mark.parametrize("value", [np.nan, np.inf, None])
def test_a_time_that_is_no_number_is_named_with_its_row(
    dataset: Path, columns: Columns, value: float | None
) -> None:
    put(dataset, pa.table(columns | {"time_s": [*columns["time_s"][:499], value]}))
    assert refusal(dataset).startswith(", row 499: time_s is null or not finite")


@pytest.mark.parametrize("back_s", [0.0, 0.5])
def test_time_that_does_not_increase_is_named_with_its_row(
    dataset: Path, columns: Columns, back_s: float
) -> None:
    columns["time_s"][30] = columns["time_s"][29] - back_s
    put(dataset, pa.table(columns))
    assert refusal(dataset).startswith(", row 30: time_s does not increase")
    run = read_dataset(dataset).manifest.run[0]
    lenient = read_recording(dataset, run, strict=False)
    np.testing.assert_array_equal(lenient.time_s, columns["time_s"])


def say(dataset: Path, columns: Columns, **units: str) -> None:
    """Put the columns with these units in their metadata."""
    fields = [pa.field(n, pa.float64(), metadata={"unit": units.get(n, "")}) for n in columns]
    put(dataset, pa.table(columns, schema=pa.schema(fields)))


@pytest.mark.parametrize(
    ("name", "unit", "expected"),
    [
        ("f_in_N", "mm", "N"),
        ("f_in_N", "kN", "N"),
        ("f_in_N", "kg", "N"),
        ("x_in_mm", "µm", "mm"),
        ("x_in_mm", "m", "mm"),
        ("x_in_mm", "what", "mm"),
        ("time_s", "ms", "s"),
    ],
)
def test_a_column_whose_metadata_name_another_unit_is_refused(
    dataset: Path, columns: Columns, name: str, unit: str, expected: str
) -> None:
    say(dataset, columns, **{name: unit})
    assert refusal(dataset) == f": column {name} has the unit {unit}; expected {expected}"


def test_a_unit_may_be_spelled_in_other_ways(dataset: Path, columns: Columns) -> None:
    say(dataset, columns, time_s="sec", x_in_mm="millimeter", f_in_N=" N ")
    assert read_recording(dataset, read_dataset(dataset).manifest.run[0]).columns.keys() == {
        *columns
    }


def test_a_column_that_is_there_twice_is_refused(dataset: Path, columns: Columns) -> None:
    force = pa.array(columns["f_in_N"])
    put(dataset, pa.table(columns).append_column("f_in_N", force))
    assert refusal(dataset) == ": duplicate column f_in_N"


def test_chosen_runs_come_in_the_order_of_the_manifest(tmp_path: Path, columns: Columns) -> None:
    table = pa.table(columns)
    manifest = Manifest.model_validate(
        {
            "format": 1,
            "name": "",
            "kind": "measured",
            "run": [{"id": i, "file": f"runs/{i}.parquet", "sha256": "0" * 64} for i in "abc"],
        }
    )
    write_dataset(tmp_path, manifest, dict.fromkeys("abc", table))
    whole = read_dataset(tmp_path)
    chosen = whole.only(["c", "a"])
    assert [recording.run.id for recording in chosen] == ["a", "c"]
    assert chosen.header(tmp_path)["dataset"] == whole.header(tmp_path)["dataset"]
    with pytest.raises(InputError, match="there is no run 'd'"):
        whole.only(["d"])


def test_other_conditions_are_said_of_every_run_and_stay_on_record(dataset: Path) -> None:
    whole = read_dataset(dataset)
    changed = whole.under(total_bend_rad=1.5, preload_N=20.0)
    (recording,) = changed
    assert (recording.run.total_bend_rad, recording.run.preload_N) == (1.5, 20.0)
    assert recording.run.sheath_length_mm is None
    assert changed.under(preload_N=10.0).conditions == {"total_bend_rad": 1.5, "preload_N": 10.0}
    assert changed.header(None) == whole.header(None) | {
        "conditions": {"total_bend_rad": 1.5, "preload_N": 20.0}
    }
    with pytest.raises(InputError, match="unknown condition bend; known are sheath_length_mm"):
        whole.under(bend=1.0)
    with pytest.raises(InputError, match=r"dataset\.toml: preload_N: expected 0, or 1e-06 to"):
        whole.under(preload_N=-1.0)


def test_what_is_read_cannot_be_written_to(dataset):
    """Each access reads the file: what was written into an array was lost without a word."""
    data = read_dataset(dataset)
    for recording in (data["a"], next(iter(data))):
        with pytest.raises(ValueError, match="read-only"):
            recording.columns["x_in_mm"][0] = 5.0
        with pytest.raises(ValueError, match="read-only"):
            recording.time_s[:] += 1.0
        with pytest.raises(TypeError, match="does not support item assignment"):
            recording.columns["x_in_mm"] = recording.time_s
        copied = copy.deepcopy(recording)
        copied.columns["x_in_mm"][0] = 5.0
        assert copied.frame()["x_in_mm"].iloc[0] == 5.0
        assert copied.run == recording.run


def test_kernels_are_given_arrays_that_they_were_compiled_for(dataset):
    run = prepare(read_dataset(dataset)["a"])
    driving = (conditioned.values for conditioned in run.conditioned.values())  # noqa: PD011
    assert all(v.flags.writeable for v in (run.time_s, *run.measured.values(), *driving))
