import sys

import numpy as np
import pytest
from asammdf import MDF, Signal

import tsas_cli as tsas
from tsas_cli.recordings.readers import mdf, offered
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

T = np.arange(5) / 10
F = np.arange(5.0) + 10


@pytest.fixture
def path(tmp_path):
    place = Signal((F * 2).astype(np.int16), T, name="place", unit="mm")
    invalid = np.array([0, 1, 0, 0, 0], dtype=bool)
    return save(
        tmp_path / "a.mf4",
        [Signal(F, T, name="force", unit="N"), place],
        [Signal(F[::2], T[::2], name="slow"), Signal(F[::2], T[::2], name="force")],
        [Signal(F, T, name="patchy", invalidation_bits=invalid)],
        [Signal(np.array([b"a"] * 5), T, name="words", encoding="utf-8")],
    )


def save(path, *groups):
    """Write groups of signals."""
    with MDF(version="4.10") as file:
        for group in groups:
            file.append(list(group))
        file.save(path)
    return path


def ask(path, *wanted, **options):
    table = offered.read(path, mdf.__name__, "MDF", ReadOptions(**options), wanted)
    return {source: values.tolist() for source, values in table.columns.items()}, table


def test_channels_units_and_the_master_as_time(path):
    columns, table = ask(path, "time", "place", 1)
    assert columns == {"time": T.tolist(), "place": (F * 2).tolist(), 1: F.tolist()}
    assert table.units == {"time": "s", "place": "mm", 1: "N"}


def test_the_master_beside_a_channel_that_is_called_time_has_a_number(tmp_path):
    path = save(tmp_path / "a.mf4", [Signal(F, T, name="time", unit="mm")])
    columns, table = ask(path, 2, 1)
    assert columns == {1: F.tolist(), 2: T.tolist()}
    assert table.units == {1: "mm", 2: "s"}


def test_samples_marked_as_invalid_are_gaps(path):
    columns, _ = ask(path, "patchy")
    assert np.isnan(columns["patchy"]).tolist() == [False, True, False, False, False]


def test_groups_of_other_rates_need_leave_to_interpolate(path):
    with pytest.raises(InputError, match=r"5 samples.*3 samples.*resample = true"):
        ask(path, "time", "place", "slow")
    columns, _ = ask(path, "time", "place", "slow", resample=True)
    assert columns["time"] == T.tolist()
    assert columns["slow"] == pytest.approx(F.tolist())


@pytest.mark.parametrize(
    ("wanted", "described"),
    [
        ("force", "2 columns have the name force; .* 1, 4"),
        ("torque", "there are: force, place, slow, force, patchy, words, time"),
        ("words", "row 1: column words"),
        ("time", "no channel besides the time"),
    ],
)
def test_what_is_wrong_is_reported(path, wanted, described):
    with pytest.raises(InputError, match=described):
        ask(path, wanted)


@pytest.mark.parametrize(
    ("master", "described"),
    [(("a", 2), "an angle in deg"), (("d", 3), "a distance in m"), (("i", 4), "a count in index")],
)
def test_a_master_that_is_no_time_is_not_taken_for_one(tmp_path, master, described):
    force = Signal(F, T, name="force", unit="N", master_metadata=master)
    path = save(tmp_path / "a.mf4", [force], [Signal(F, T, name="place", unit="mm")])
    with pytest.raises(InputError, match=f"clock of the channels is {described}; .*rate_Hz"):
        ask(path, "time", "force")
    with pytest.raises(InputError, match=f"clock of the channels is {described}, a time in s;"):
        ask(path, "force", "place", resample=True)
    assert ask(path, "force")[0]["force"] == F.tolist()  # for a map with rate_Hz


@pytest.mark.parametrize("version", ["3.30", "4.10"])
@pytest.mark.parametrize(("described", "unit"), [("ms", "ms"), ("", "s")])
def test_the_unit_of_the_master_counts(tmp_path, version, described, unit):
    path = tmp_path / ("a.mdf" if version < "4" else "a.mf4")
    with MDF(version=version) as file:
        file.append([Signal(F, T, name="force", unit="N")])
        master = file.groups[0].channels[0]
        (master.conversion or master).unit = described
        file.save(path)
    assert ask(path, "time", "force")[1].units == {"time": unit, "force": "N"}


def test_complex_samples_are_refused(tmp_path):
    path = save(tmp_path / "a.mf4", [Signal(F + 1j, T, name="force", unit="N")])
    with pytest.raises(InputError, match="column force holds complex128; expected real numbers"):
        ask(path, "force")


@pytest.mark.parametrize("kept", [0, 200, 0.99])
def test_a_file_that_is_cut_short_is_one_line_and_nothing_else(path, capfd, kept):
    content = path.read_bytes()
    path.write_bytes(content[: kept if isinstance(kept, int) else int(kept * len(content))])
    map_path = path.with_name("map.toml")
    map_path.write_text(
        '[dataset]\nname = "m"\n[columns]\ntime_s = {source = "time"}\n'
        'x_in_mm = {source = "place"}\nf_in_N = {source = 1}\n'
    )
    with pytest.raises(InputError) as raised:
        tsas.ingest(path, map=map_path, out=path.with_name("out"))
    assert raised.value.line().startswith(f"{path}: ")
    assert capfd.readouterr() == ("", "")


def test_the_missing_package_is_named(path, monkeypatch):
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(InputError, match=r"install 'tsas\[mdf\]'"):
        ask(path, "place")
