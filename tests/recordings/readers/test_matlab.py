import numpy as np
import pytest

from tests.recordings.readers.matlab_files import (
    controldesk,
    numbers,
    save_5,
    save_73,
    struct,
    struct_array,
    text,
)
from tests.refusals import refusal
from tsas_cli.recordings.readers import matlab, offered, read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

T = np.arange(5) / 10
F = np.arange(5.0) + 10
FORCE, SPEED = "Model Root/Force/Out1", "Model Root/Speed/Out1"


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.mat"


def ask(path, *wanted, **options):
    table = read(path, ReadOptions(**options), wanted)
    return {source: values.tolist() for source, values in table.columns.items()}, table


def plain_5(path):
    inner = {"a": T, "b": {"c": F}}
    matrices = {"m": np.c_[T, F], "across": np.array([T, F])}
    save_5(path, t=T, i=np.arange(5, dtype=np.int16), **matrices, s=inner, note="50 mm")


def plain_73(path):
    def build(file):
        numbers(file, "t", T)
        numbers(file, "i", np.arange(5))
        numbers(file, "m", np.c_[T, F])
        numbers(file, "across", np.array([T, F]))
        numbers(struct(file, "s"), "a", T)
        numbers(struct(file["s"], "b"), "c", F)
        text(file, "note", "50 mm")

    save_73(path, build)


@pytest.mark.parametrize("write", [plain_5, plain_73])
def test_vectors_matrices_and_structs_have_names(path, write):
    write(path)
    expected = {"t": T, "i": np.arange(5.0), "m(:,2)": F, "s.a": T, "s.b.c": F}
    expected["across(:,2)"] = F  # samples lie along the longer side
    columns, table = ask(path, *expected)
    assert columns == {name: values.tolist() for name, values in expected.items()}
    assert "note = 50 mm" in table.header
    assert ask(path, "b.c", table="s")[0] == {"b.c": F.tolist()}


def one_channel_5(path):
    save_5(path, rec001=controldesk([T], [(f'"{FORCE}"', F, "N", 1)]))


def two_channels_5(path):
    channels = [(f'"{SPEED}"', F * 2, "rpm", 1), (f'"{FORCE}"', F, "N", 1)]
    save_5(path, rec001=controldesk([T], channels))


def capture_73(path, fill):
    """Write a capture whose channels are filled in."""

    def build(file):
        capture = struct(file, "rec001")
        numbers(struct(capture, "X"), "Data", T)
        fill(file, capture)

    save_73(path, build)


def one_channel_73(path):
    def fill(_, capture):
        channel = struct(capture, "Y")
        text(channel, "Name", FORCE)
        numbers(channel, "Data", F)
        text(channel, "Unit", "N")

    capture_73(path, fill)


def two_channels_73(path):
    speed = {"Name": SPEED, "Data": F * 2, "Unit": "rpm"}
    force = {"Name": FORCE, "Data": F, "Unit": "N"}
    capture_73(path, lambda file, capture: struct_array(file, capture, "Y", [speed, force]))


@pytest.mark.parametrize("write", [one_channel_5, two_channels_5, one_channel_73, two_channels_73])
def test_a_controldesk_capture_of_one_or_more_channels(path, write):
    write(path)
    columns, table = ask(path, "time", FORCE)
    assert columns == {"time": T.tolist(), FORCE: F.tolist()}
    assert table.units == {"time": "s", FORCE: "N"}


def test_the_clock_beside_a_channel_that_is_called_time_has_a_number(path):
    save_5(path, rec001=controldesk([T], [("time", F, "N", 1)]))
    columns, table = ask(path, 2, 1)
    assert columns == {1: F.tolist(), 2: T.tolist()}
    assert table.units == {1: "N", 2: "s"}


def test_a_capture_with_two_rasters_needs_leave_to_interpolate(path):
    channels = [(FORCE, F, "N", 1), (SPEED, F[::2], "rpm", 2)]
    save_5(path, rec001=controldesk([T, T[::2]], channels))
    with pytest.raises(InputError, match=r"different times.*resample = true"):
        ask(path, "time", FORCE, SPEED)
    columns, _ = ask(path, "time", FORCE, SPEED, resample=True)
    assert columns["time"] == T.tolist()
    assert columns[SPEED] == pytest.approx(F.tolist())


def test_two_captures_are_not_chosen_between(path):
    save_5(path, **{n: controldesk([T], [(FORCE, v, "N", 1)]) for n, v in (("a", T), ("b", F))})
    with pytest.raises(InputError, match="holds 2 captures: a, b"):
        ask(path, FORCE)
    assert ask(path, "time", FORCE, table="b")[0] == {"time": T.tolist(), FORCE: F.tolist()}


def test_a_missing_channel_lists_those_that_are_there(path):
    two_channels_5(path)
    with pytest.raises(InputError, match=rf"Torque is missing.*{FORCE}"):
        ask(path, "Torque")


@pytest.mark.parametrize("write", [plain_5, plain_73])
@pytest.mark.parametrize("kept", [0, 300, 0.98])
def test_a_file_that_is_cut_short_is_one_line(path, write, kept):
    write(path)
    content = path.read_bytes()
    path.write_bytes(content[: kept if isinstance(kept, int) else int(kept * len(content))])
    assert str(path) in refusal(ask, path, "m(:,2)")


def test_the_missing_package_is_named(path, monkeypatch):
    plain_73(path)
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    with pytest.raises(InputError, match=r"-m pip install 'tsas\[mat\]'"):
        offered.names(path, matlab.__name__, "a MATLAB file", ReadOptions())


@pytest.mark.parametrize(
    ("content", "wanted", "message"),
    [
        (controldesk([T], [(FORCE, F + 1j, "N", 1)]), FORCE, "holds complex128; expected real"),
        (np.array(["a", "b"], dtype=object), "c", "column c is missing"),
    ],
)
def test_what_is_no_column_of_numbers_is_refused(path, content, wanted, message):
    save_5(path, c=content)
    with pytest.raises(InputError, match=message):
        ask(path, wanted)
