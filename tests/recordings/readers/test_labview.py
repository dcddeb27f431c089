"""Files of LabVIEW: LVM and TDMS."""

import numpy as np
import pytest
from nptdms import ChannelObject, RootObject, TdmsWriter

from tests.recordings.guess.rig_files import CHANNELS, run, sources
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

HEAD = """LabVIEW Measurement\t
Separator\tTab
Decimal_Separator\t{point}
X_Columns\t{x}
***End_of_Header***\t

"""
SEGMENT = """Channels\t2\t
Y_Unit_Label\tN\tmm
X_Dimension\tTime\tTime
Delta_X\t0{point}125\t0{point}125
***End_of_Header***\t
X_Value\tForce µ\tPos\tComment
"""
TIME = np.arange(4) / 8


def lvm(path, *, point=".", x="One", segments=1, encoding="utf-8"):
    text = HEAD.format(point=point, x=x)
    for _ in range(segments):
        text += SEGMENT.format(point=point)
        for i, t in enumerate(TIME):
            cells = ["" if x == "No" else f"{t}", f"{t + 1}", f"-{t}"]
            text += "\t".join(cells).replace(".", point) + ("\tstart" if i == 0 else "") + "\n"
    path.write_text(text, encoding=encoding)
    return path


@pytest.mark.parametrize(
    "how", [{}, {"point": ","}, {"x": "No"}, {"x": "No", "point": ","}, {"encoding": "cp1252"}]
)
def test_lvm(tmp_path, how):
    table = read(lvm(tmp_path / "a.lvm", **how), ReadOptions(), ["X_Value", "Force µ", 3])
    np.testing.assert_array_equal(table.columns["X_Value"], TIME)
    np.testing.assert_array_equal(table.columns["Force µ"], TIME + 1)
    np.testing.assert_array_equal(table.columns[3], -TIME)
    assert table.units == {"X_Value": "s", "Force µ": "N", 3: "mm"}


def test_segments_of_lvm_follow_each_other(tmp_path):
    path = lvm(tmp_path / "a.lvm", segments=2)
    np.testing.assert_array_equal(read(path, ReadOptions(), [2]).columns[2], [*TIME + 1, *TIME + 1])
    path.write_text(path.read_text().replace("Force", "Other", 1))
    with pytest.raises(InputError, match="its segments have different channels"):
        names(path, ReadOptions())


def tdms(path, groups, **properties):
    with TdmsWriter(path) as file:
        channels = [
            ChannelObject(group, name, values, properties | said)
            for group, listed in groups.items()
            for name, (values, said) in listed.items()
        ]
        file.write_segment([RootObject({"operator": "M"}), *channels])
    return path


def test_tdms_of_columns(tmp_path):
    listed = {"t": (TIME, {"unit_string": "s"}), "f": (TIME.astype("f4"), {}), "w": (["a"], {})}
    path = tdms(tmp_path / "a.tdms", {"log": listed})
    assert names(path, ReadOptions()) == ("t", "f")
    table = read(path, ReadOptions(), ["t", "f"])
    np.testing.assert_array_equal(table.columns["f"], TIME)
    assert (table.units, table.header) == ({"t": "s"}, ("operator = M",))


def test_tdms_with_clocks_of_its_channels(tmp_path):
    start = np.datetime64("2026-03-03T10:00:00")
    fast = {"wf_increment": 0.125, "wf_start_offset": 0.0, "wf_start_time": start}
    late = fast | {"wf_increment": 0.25, "wf_start_time": start + np.timedelta64(125, "ms")}
    groups = {"a": {"f": (np.arange(8.0), fast)}, "b": {"x": (np.arange(3.0), late)}}
    path = tdms(tmp_path / "a.tdms", groups)
    assert names(path, ReadOptions()) == ("a/f", "b/x", "time")
    with pytest.raises(InputError, match="the channels have different times"):
        read(path, ReadOptions(), ["time", "a/f", "b/x"])
    table = read(path, ReadOptions(resample=True), ["time", "a/f", "b/x"])
    np.testing.assert_allclose(table.columns["time"], 0.125 * np.arange(1, 6))
    np.testing.assert_allclose(table.columns["a/f"], np.arange(1, 6))
    np.testing.assert_allclose(table.columns["b/x"], np.arange(5) / 2)


def test_the_clock_of_lvm_is_no_displacement(tmp_path):
    head = HEAD.format(point=".", x="One") + "Channels\t4\nY_Unit_Label\tmm\tmm\tN\tN\n"
    names = "\t".join(["X_Value", *CHANNELS[1:]])
    rows = ("\t".join(map(str, row)) for row in zip(*run().values(), strict=True))
    (tmp_path / "a.lvm").write_text("\n".join([f"{head}***End_of_Header***\n{names}", *rows]))
    assert sources(tmp_path / "a.lvm")["time_s"] == "X_Value"
    assert propose([tmp_path / "a.lvm"]).doubt == ""
