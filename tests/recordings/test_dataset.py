import copy
import hashlib

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.recordings.rewritten import rewrite
from tests.refusals import refusal as refused
from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.errors import InputError


def only(folder):
    (recording,) = read_dataset(folder)
    return recording


def refusal(folder):
    return refused(only, folder).removeprefix(str(folder / "runs" / "a.parquet"))


def test_what_is_written_is_read_to_the_last_bit(dataset, columns):
    recording = only(dataset)
    assert set(recording.columns) == set(columns)
    for name, values in columns.items():
        np.testing.assert_array_equal(recording.columns[name], values)
    assert recording.time_s is recording.columns["time_s"]
    assert recording.get("f_out_N") is None
    assert recording.run.preload_N == 25.0


def test_each_known_column_carries_its_unit_in_the_file(dataset):
    schema = pq.read_schema(dataset / "runs" / "a.parquet")
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert units == {"time_s": "s", "x_in_mm": "mm", "f_in_N": "N"}


def test_the_hashes_are_those_of_the_files(dataset):
    expected = {
        name: hashlib.sha256((dataset / name).read_bytes()).hexdigest()
        for name in ("dataset.toml", "runs/a.parquet")
    }
    assert read_dataset(dataset).hashes() == expected


def test_unknown_columns_travel_along_untouched(tmp_path, manifest, columns):
    note = pa.array(["μ"] * 499 + [None])
    write_dataset(tmp_path, manifest, {"a": pa.table(columns | {"note": note})})
    assert pq.read_table(tmp_path / "runs" / "a.parquet")["note"].combine_chunks() == note
    assert "note" not in only(tmp_path).columns


@pytest.mark.parametrize("kind", ["float32", "int64", "uint8"])
def test_other_kinds_of_numbers_are_accepted(dataset, columns, kind):
    """The times, in nanoseconds, are integers beyond the exact floats."""
    force, time_ns = columns["f_in_N"].astype(kind), 2**60 + np.arange(500) * 1_000_000
    rewrite(dataset, pa.table(columns | {"f_in_N": force, "time_s": time_ns}))
    read = only(dataset).columns
    assert read["f_in_N"].dtype == np.float64
    np.testing.assert_array_equal(read["f_in_N"], force.astype(float))
    assert read["time_s"][-1] == pytest.approx(time_ns[-1])


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize("factor", [1e-150, 5e-324])
def test_a_channel_whose_squares_vanish_is_refused(dataset, columns, factor, strict):
    rewrite(dataset, pa.table(columns | {"f_in_N": columns["f_in_N"] * factor}))
    with pytest.raises(InputError, match=r"f_in_N never exceeds .* N; expected zero, or a magn"):
        read_recording(dataset, read_dataset(dataset).runs[0], strict=strict)
    for force in (columns["f_in_N"] * 0.0, np.where(np.arange(500) < 9, 5e-324, 1.0)):
        rewrite(dataset, pa.table(columns | {"f_in_N": force}))
        assert only(dataset).columns["f_in_N"].max() in (0.0, 1.0)


def test_a_dataset_made_by_pandas_alone_works(tmp_path, columns):
    frame = pd.DataFrame(columns).assign(f_out_N=lambda t: t.f_in_N.where(t.index != 3))
    frame.to_parquet(tmp_path / "first run.parquet")
    digest = hashlib.sha256((tmp_path / "first run.parquet").read_bytes()).hexdigest()
    (tmp_path / "dataset.toml").write_text(
        'format = 1\nname = "mine"\nkind = "measured"\n'
        f'[[run]]\nid = "1"\nfile = "first run.parquet"\nsha256 = "{digest.upper()}"\n'
    )
    recording = only(tmp_path)
    np.testing.assert_array_equal(recording.columns["x_in_mm"], columns["x_in_mm"])
    assert np.flatnonzero(np.isnan(recording.columns["f_out_N"])).tolist() == [3]


def test_a_file_that_is_changed_or_missing_is_one_line(dataset, columns):
    path = dataset / "runs" / "a.parquet"
    pq.write_table(pa.table(columns | {"f_in_N": columns["x_in_mm"]}), path)
    assert refusal(dataset).startswith(": the checksum differs from the manifest's; expected ")
    path.unlink()
    assert refusal(dataset).startswith(": the run's file is missing")


@pytest.mark.parametrize(
    "damage",
    [
        *(lambda content, size=size: content[:size] for size in (0, 3, 8, 2000, -1)),
        lambda content: content.replace(b"x_in_mm", b"x_in_m\xff"),
    ],
)
def test_a_damaged_file_is_one_line(dataset, damage):
    rewrite(dataset, damage((dataset / "runs" / "a.parquet").read_bytes()))
    assert refusal(dataset).startswith(": cannot be read as Parquet (")


def changed(name, row, value):
    """Return a change of one cell, and of the rows behind where it is a list."""

    def change(columns):
        columns[name][row : row + np.size(value)] = value
        return columns

    return change


def without(*names):
    return lambda columns: {n: v for n, v in columns.items() if n not in names}


def scaled(factor):
    return lambda columns: columns | {"time_s": factor * columns["time_s"]}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda c: without("time_s")(c) | {"Time [ms]": np.arange(500)},
            ": column time_s is missing; expected time in s; there are: x_in_mm, f_in_N, Time [ms]",
        ),
        (without("x_in_mm"), ": an input and an output column are needed"),
        (without("f_in_N"), ": an input and an output column are needed"),
        (without("x_in_mm", "f_in_N"), ": an input and an output column are needed"),
        (lambda c: {n: v[:0] for n, v in c.items()}, ": 0 rows; expected at least two samples"),
        (lambda c: {n: v[:1] for n, v in c.items()}, ": 1 row; expected at least two samples"),
        (lambda c: c | {"f_in_N": ["5 N"] * 500}, ": column f_in_N holds "),
        (lambda c: c | {"f_in_N": [True] * 500}, ": column f_in_N holds "),
        (changed("f_in_N", 12, np.inf), ", row 12: f_in_N is infinite"),
        (scaled(1e-100), ", row 1: time_s increases by "),
        (scaled(1e100), ", row 1: time_s increases by "),
        (
            lambda c: c | {"time_s": c["time_s"] + 1e7 * (np.arange(500) > 99)},
            ", row 100: the recording pauses for 1e+07 s; expected at most 1000 times all",
        ),
        (
            changed("time_s", 0, [0.0, 5e-324]),
            ", row 1: time_s increases by 4.94066e-324 s; expected steps",
        ),
        *(
            (lambda c, end=end: c | {"time_s": [*c["time_s"][:499], end]},
             ", row 499: time_s is null or not finite")
            for end in (np.nan, np.inf, None)
        ),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_refused_with_its_place(dataset, columns, change, message):
    rewrite(dataset, pa.table(change(columns)))
    assert refusal(dataset).startswith(message)


@pytest.mark.parametrize(
    ("name", "row", "value", "message"),
    [
        ("x_in_mm", 12, 3.4e38, "x_in_mm is 3.4e+38; expected a magnitude of at most 1e+06 mm"),
        ("x_in_mm", 12, -1.1e6, "x_in_mm is -1.1e+06; expected a magnitude of at most 1e+06 mm"),
        ("f_in_N", 12, 1e10, "f_in_N is 1e+10; expected a magnitude of at most 1e+09 N"),
        ("time_s", 30, 0.029, "time_s does not increase"),
        ("time_s", 30, -0.471, "time_s does not increase"),
    ],
)
def test_a_check_may_see_what_is_refused_elsewhere(dataset, columns, name, row, value, message):
    columns[name][row] = value
    run = rewrite(dataset, pa.table(columns))
    assert refusal(dataset).startswith(f", row {row}: {message}")
    lenient = read_recording(dataset, run, strict=False)
    np.testing.assert_array_equal(lenient.columns[name], columns[name])


def say(dataset, columns, **units):
    """Put the columns with these units in their metadata."""
    fields = [pa.field(n, pa.float64(), metadata={"unit": units.get(n, "")}) for n in columns]
    rewrite(dataset, pa.table(columns, schema=pa.schema(fields)))


@pytest.mark.parametrize(
    ("name", "units"),
    [("f_in_N", ["mm", "kN", "kg"]), ("x_in_mm", ["µm", "m", "what"]), ("time_s", ["ms"])],
)
def test_a_column_whose_metadata_name_another_unit_is_refused(dataset, columns, name, units):
    for unit in units:
        say(dataset, columns, **{name: unit})
        expected = name.rsplit("_", 1)[1]
        assert refusal(dataset) == f": column {name} has the unit {unit}; expected {expected}"


def test_a_unit_may_be_spelled_in_other_ways(dataset, columns):
    say(dataset, columns, time_s="sec", x_in_mm="millimeter", f_in_N=" N ")
    assert set(only(dataset).columns) == set(columns)


def test_a_column_that_is_there_twice_is_refused(dataset, columns):
    rewrite(dataset, pa.table(columns).append_column("f_in_N", pa.array(columns["f_in_N"])))
    assert refusal(dataset) == ": duplicate column f_in_N"


def test_chosen_runs_come_in_the_order_of_the_manifest(tmp_path, columns):
    runs = [{"id": i, "file": f"runs/{i}.parquet", "sha256": "0" * 64} for i in "abc"]
    manifest = Manifest(format=1, name="bench", kind="measured", run=runs)
    write_dataset(tmp_path, manifest, dict.fromkeys("abc", pa.table(columns)))
    whole = read_dataset(tmp_path)
    chosen = whole.only(["c", "a"])
    assert [recording.run.id for recording in chosen] == ["a", "c"]
    assert chosen.header(tmp_path)["dataset"] == whole.header(tmp_path)["dataset"]
    with pytest.raises(InputError, match="there is no run 'd'"):
        whole.only(["d"])


def test_other_conditions_are_said_of_every_run_and_stay_on_record(dataset):
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
