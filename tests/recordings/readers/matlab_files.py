"""MATLAB files as MATLAB and ControlDesk write them: version 5 by scipy, 7.3 by h5py."""

import h5py
import numpy as np
from scipy.io import savemat


def controldesk(clocks, channels):
    """Return a capture: clocks are arrays, channels are (name, values, unit, number of clock)."""
    x = np.zeros(len(clocks), dtype=[("Name", object), ("Data", object), ("Unit", object)])
    y = np.zeros(
        len(channels),
        dtype=[("Name", object), ("Data", object), ("Unit", object), ("XIndex", object)],
    )
    for i, clock in enumerate(clocks):
        x[i] = ("time", clock, "s")
    for i, channel in enumerate(channels):
        y[i] = channel
    return {"X": x, "Y": y, "Description": "bench 42"}


def save_5(path, **variables):
    savemat(path, variables)


def save_73(path, build):
    """Write HDF5 behind MATLAB's own 512 bytes; `build` fills the open file."""
    with h5py.File(path, "w", userblock_size=512) as file:
        build(file)
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def numbers(group, name, values):
    """Write a matrix as MATLAB does, columns first."""
    item = group.create_dataset(name, data=np.atleast_2d(np.asarray(values, dtype=float)).T)
    item.attrs["MATLAB_class"] = np.bytes_("double")
    return item


def save_struct_73(path, name, columns):
    """Write columns as the members of a struct."""

    def build(file):
        group = struct(file, name)
        for member, values in columns.items():
            numbers(group, member, values)

    save_73(path, build)


def text(group, name, words):
    item = group.create_dataset(name, data=np.array([[ord(c)] for c in words], dtype=np.uint16))
    item.attrs["MATLAB_class"] = np.bytes_("char")
    return item


def struct(group, name):
    item = group.create_group(name)
    item.attrs["MATLAB_class"] = np.bytes_("struct")
    return item


def struct_array(file, group, name, records):
    """Write a struct array: one dataset of bare references for each member."""
    targets = file.require_group("#refs#")
    array = struct(group, name)
    for member in records[0]:
        references = []
        for i, record in enumerate(records):
            write = text if isinstance(record[member], str) else numbers
            references.append(write(targets, f"{name}{member}{i}", record[member]).ref)
        array.create_dataset(
            member, data=np.array(references, dtype=h5py.ref_dtype)[:, None], dtype=h5py.ref_dtype
        )
