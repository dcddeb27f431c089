"""Formats whose readers offer named arrays: known numbers come back, whatever holds them."""

import json

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from pyarrow import feather

from tests.refusals import refusal
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

TIME = np.arange(5) / 8
FORCE = np.array([1.5, np.nan, -3e300, 4.0, 5.0])
START = np.datetime64("2026-03-03T10:00:00.5")
DATES = START + (1000 * TIME).astype("timedelta64[ms]")


def hdf5(path):
    with h5py.File(path, "w") as file:
        file.attrs["operator"] = "M"
        group = file.create_group("bench")
        group["t"] = TIME
        group["t"].attrs["unit"] = "s"
        group.create_dataset("f", data=FORCE, compression="gzip", chunks=True)
        group["f"].attrs["units"] = b"N"
        file["m"] = np.c_[TIME, FORCE]
        file["across"] = np.array([TIME, FORCE])
        file["rows"] = np.array(list(zip(TIME, FORCE, strict=True)), [("t", "f8"), ("f", "f8")])
        file["word"] = "a"
        file["link"] = h5py.SoftLink("/bench/t")
        file["elsewhere"] = h5py.ExternalLink("other.h5", "/t")


def npz(path):
    np.savez(path, t=TIME, f=FORCE, m=np.c_[TIME, FORCE], objects=np.array([{}, 1], dtype=object))


def as_feather(path):
    table = pa.table(
        {"t": TIME, "f": pa.array(FORCE, from_pandas=True), "when": DATES, "w": ["a"] * 5}
    )
    field = table.schema.field("f").with_metadata({"unit": "N"})
    feather.write_feather(table.set_column(1, field, table.column(1)), path)


@pytest.mark.parametrize(
    ("name", "write", "time", "force"),
    [
        ("a.h5", hdf5, "bench/t", "bench/f"),
        ("a.hdf5", hdf5, "m(:,1)", "m(:,2)"),
        ("a.h5", hdf5, "across(:,1)", "across(:,2)"),
        ("a.h5", hdf5, "rows.t", "rows.f"),
        ("a.npz", npz, "t", "f"),
        ("a.npz", npz, "m(:,1)", "m(:,2)"),
        ("a.npy", lambda path: np.save(path, np.c_[TIME, FORCE]), 1, 2),
        ("a.npy", lambda path: np.save(path, np.array([TIME, FORCE])), 1, 2),
        ("a.feather", as_feather, "t", "f"),
        ("a.arrow", as_feather, "when", "f"),
    ],
)  # fmt: skip
def test_numbers_come_back(tmp_path, name, write, time, force):
    write(tmp_path / name)
    table = read(tmp_path / name, ReadOptions(), [time, force])
    np.testing.assert_array_equal(table.columns[time], TIME)
    np.testing.assert_array_equal(table.columns[force], FORCE)
    if name.endswith((".feather", ".arrow")) or str(force).startswith("bench"):
        assert table.units[force] == "N"


def test_dates_have_a_unit_of_their_own_and_text_among_numbers_is_named(tmp_path):
    as_feather(tmp_path / "a.feather")
    table = read(tmp_path / "a.feather", ReadOptions(), ["when"])
    assert (table.units, table.typed) == ({"when": "s"}, {"when"})
    with pytest.raises(InputError, match="column w holds 'a'"):
        read(tmp_path / "a.feather", ReadOptions(), ["w"])


def test_text_of_hdf5_is_the_header_and_links_and_objects_are_no_columns(tmp_path):
    hdf5(tmp_path / "a.h5")
    npz(tmp_path / "a.npz")
    assert read(tmp_path / "a.h5", ReadOptions(), ["bench/t"]).header == ("operator = M",)
    assert not {"link", "elsewhere", "word"} & set(names(tmp_path / "a.h5", ReadOptions()))
    assert "objects" not in names(tmp_path / "a.npz", ReadOptions())


@pytest.mark.parametrize(("how", "message"), [
    ({"external": [("passwords", 0, 40)]}, "data of x are in another file"),
    ({"compression": "gzip"}, "at most 500 times its size"),  # zeros that fill the memory
])  # fmt: skip
def test_what_a_file_does_not_hold_itself_is_refused(tmp_path, how, message):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", (5 if "external" in how else 1 << 40,), "f8", **how)
    assert message in refusal(read, tmp_path / "a.h5", ReadOptions(), ["x"])


@pytest.mark.parametrize("name", ["a.jsonl", "a.npz", "a.feather", "a.parquet", "a.h5"])
def test_a_unit_in_brackets_counts_in_any_format(tmp_path, name):
    data = {"Time [s]": TIME, "F (kN)": FORCE, "x [mm]": TIME, "F": FORCE}
    path = tmp_path / name
    if name == "a.jsonl":
        rows = zip(*(values.tolist() for values in data.values()), strict=True)
        path.write_text("\n".join(json.dumps(dict(zip(data, row, strict=True))) for row in rows))
    elif name == "a.npz":
        np.savez(path, **data)
    elif name == "a.h5":
        with h5py.File(path, "w") as file:
            for key, values in data.items():
                file[key] = values
            file["x [mm]"].attrs["unit"] = "m"  # what the file states counts more
    else:
        (feather.write_feather if name == "a.feather" else pq.write_table)(pa.table(data), path)
    units = {"Time [s]": "s", "F (kN)": "kN", "x [mm]": "m" if name == "a.h5" else "mm"}
    assert read(path, ReadOptions(), [*data]).units == units


def test_the_number_of_a_column_of_a_matrix_is_no_unit(tmp_path):
    hdf5(tmp_path / "a.h5")
    assert read(tmp_path / "a.h5", ReadOptions(), ["m(:,1)", "m(:,2)"]).units == {}
