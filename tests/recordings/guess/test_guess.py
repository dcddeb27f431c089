import os
import re
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.recordings.guess.rig_files import (
    CHANNELS,
    in_unit,
    judged,
    run,
    sources,
    verdicts,
    write_csv,
    write_run,
)
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.recordings.ingest_map import read_map

FEWER = settings(
    max_examples=settings.default.max_examples * 6 // 10, suppress_health_check=list(HealthCheck)
)
REPOSITORY = Path(__file__).parents[3]
MAPS = REPOSITORY / "datasets" / "maps"
LABS = {
    "ours": ", ".join(CHANNELS),
    "readme": "Time [ms], Turntable [deg], Load [mm], Cell drive [lbf], Cell load [N]",
    "short": "t (s), xin (mm), xout (mm), Fin (N), Fout (N)",
    "proximal": "Timestamp_ms, pos_prox_mm, pos_dist_mm, tension_proximal_N, tension_distal_N",
    "tensions": "time_s, x_in_mm, x_out_mm, T_in [N], T_out [N]",
    "masters": "Time [s], Master position [in], Slave position [in], Master force [kgf], "
    "Slave force [kgf]",
    "cells": "Elapsed time [us], Input displacement [cm], Tip displacement [um], "
    "Load cell input [N], Load cell output [N]",
    "torques": "Time (s), Drive angle (rad), Output angle (rad), Drive torque [N.m], "
    "Output torque [N.m]",
    "german": "Zeit [ms], Antriebsweg [mm], Abtriebsweg [mm], Antriebskraft [N], Abtriebskraft [N]",
    "winkel": "Zeit [s], Winkel Antrieb [Grad], Weg Ausgang [mm], Zugkraft Eingang [kN], "
    "Zugkraft Ausgang [kN]",
    "french": "Temps [s], Déplacement entrée [mm], Déplacement sortie [mm], Effort entrée [N], "
    "Effort sortie [N]",
    "chinese": "时间 [s], 输入位移 [mm], 输出位移 [mm], 输入力 [N], 输出力 [N]",
    "camel": "TimeMs, DrivePos, LoadPos, DriveForce, LoadForce",
}


def write_lab(path, lab):
    """Write the run under a lab's names, in the units that they state, and return the names."""
    names, columns = LABS[lab].split(", "), []
    for channel, name in zip(CHANNELS, names, strict=True):
        stated = re.search(r"[\[(](.+)[\])]|_([a-zA-Z]+)$", name)
        unit = stated[1] or stated[2] if stated else channel.rsplit("_", 1)[1]
        columns.append((name, in_unit(channel, unit)))
    write_csv(path, columns)
    return names


@pytest.mark.parametrize("lab", LABS)
def test_the_names_of_many_labs_are_understood(path, lab):
    found = verdicts(path, dict(zip(CHANNELS, write_lab(path, lab), strict=True)))
    expected = dict.fromkeys(CHANNELS, "right")
    if lab == "camel":  # no units: the clock's is told by its steps, the others are asked for
        expected = dict.fromkeys(CHANNELS, "open") | {"time_s": "right"}
    assert found == expected


def test_a_row_of_units_a_decimal_comma_a_preamble_and_an_old_encoding(tmp_path):
    truth = {
        "time_s": "Zeit",
        "x_in_mm": "Weg Antrieb",
        "f_in_N": "Kraft Antrieb",
        "f_out_N": "Kraft Last",
    }
    rows = ["Prüfbericht Nr. 7", "Prüfer: Müller", "", ";".join(truth.values()), "ms;µm;N;N"]
    for t, x, f, g in zip(*(run()[n] for n in truth), strict=True):
        rows.append(f"{1e3 * t:.1f};{1e3 * x:.0f};{f:.2f};{g:.2f}".replace(".", ","))
    path = tmp_path / "a.txt"
    path.write_bytes("\r\n".join(rows).encode("cp1252"))
    proposal = propose([path])
    assert proposal.read["encoding"][0] == "cp1252"
    assert proposal.read["skip_lines"][0] in (1, 2, 3)
    assert sources(path) == truth
    assert proposal.questions == {}


def test_chinese_names_in_the_encoding_of_windows_are_understood(path):
    write_lab(path, "chinese")
    path.write_bytes(path.read_text(encoding="utf-8").encode("gbk"))
    proposal = propose([path])
    assert proposal.read["encoding"][0] == "gb18030"
    assert proposal.questions == {}
    assert set(sources(path)) == set(CHANNELS)


@pytest.mark.parametrize(
    ("names", "asked"),
    [
        ({"x_in_mm": "drive [mm]", "f_out_N": "cell out [N]"}, "f_in_N"),
        ({"x_out_mm": "tip [mm]", "f_in_N": "cell in [N]"}, "x_in_mm"),
    ],
)
def test_x_in_or_f_in_that_no_column_is_left_for_is_asked(path, names, asked):
    proposal = propose([write_run(path, time_s="t [s]", **names)])
    question = proposal.questions[f"columns.{asked}.source"]
    assert "delete this table" in question
    assert "is it in another file" in question
    assert proposal.is_a_recording


def test_of_a_drive_alone_no_force_is_asked_for(path):
    write_run(path, time_s="t [s]", x_in_mm="motor [rpm]", x_out_mm="drive [mm]")
    assert "f_in_N" not in sources(path)


def test_a_force_that_one_cell_spoils_is_asked_for_by_its_name(path):
    names = {"time_s": "t [s]", "x_in_mm": "drive [mm]", "x_out_mm": "tip [mm]"}
    write_run(path, **names, f_in_N="force in [N]")
    rows = [f"{row},a" for row in path.read_text().splitlines()]
    rows[0] = rows[0].replace(",a", ",note")
    rows[-1] = ",".join([*rows[-1].split(",")[:3], "ERR", "a"])
    path.write_text("\n".join(rows))
    question = propose([path]).questions["columns.f_in_N.source"]
    assert question.startswith("is it force in [N], which cannot be used: ")
    assert "ERR" in question
    assert "Then correct the file. Or is it in another file" in question
    assert "note" not in question


def test_a_reference_may_stand_for_a_drive_that_was_not_recorded(path):
    names = {"time_s": "t [s]", "x_in_mm": "desired [mm]", "x_out_mm": "tip [mm]"}
    write_run(path, **names, f_in_N="cell in [N]")
    (x_in,) = (c for c in propose([path]).channels if c.name == "x_in_mm")
    assert x_in.certainty == "open"
    assert x_in.candidates == ("desired [mm]",)
    assert "its reference will do" in x_in.questions["source"]


def test_exchanged_load_cells_leave_the_displacements_as_they_are(path):
    found = judged(path, ["time [s]", "x_in [mm]", "x_out [mm]", "f_out [N]", "f_in [N]"])
    assert found == dict.fromkeys(CHANNELS, "right") | {"f_in_N": "open", "f_out_N": "open"}


ORDERS = list(permutations(range(4)))[1:]
TWO = [order for order in ORDERS if sum(np.array(order) == range(4)) == 2]
EACH_TIME = {*TWO, (1, 2, 3, 0), (3, 2, 1, 0)}


@pytest.mark.parametrize(
    "order", [pytest.param(o, marks=() if o in EACH_TIME else pytest.mark.large) for o in ORDERS]
)
@pytest.mark.parametrize("units", [["[mm]", "[mm]", "[N]", "[N]"], [""] * 4])
def test_no_exchange_of_names_is_believed(path, order, units):
    if order == (0, 3, 2, 1) and not any(units):
        pytest.skip("displacement and tension of a spring look alike: without units names decide")
    stems = [("x_in", "x_out", "f_in", "f_out")[i] for i in order]
    names = ["time [s]", *(f"{s} {u}".strip() for s, u in zip(stems, units, strict=True))]
    assert "wrong" not in judged(path, names).values()


@pytest.mark.parametrize("names", [["A", "B", "C", "D", "E"], [""] * 5])
def test_without_names_only_the_clock_is_told(path, names):
    assert judged(path, names) == dict.fromkeys(CHANNELS, "open") | {"time_s": "right"}
    assert "is nearer to the drive than" in map_text(propose([path]))


NUMBERED = ["1 [s]", "2 [mm]", "3 [mm]", "4 [N]", "5 [N]"]


def test_units_alone_and_the_motion_tell_the_ends(path):
    assert judged(path, NUMBERED) == dict.fromkeys(CHANNELS, "right")
    assert {c.certainty for c in propose([path]).channels} == {"sure", "likely"}


def test_signs_that_are_turned_are_turned_back(path):
    found = judged(path, CHANNELS, x_in_mm=-run()["x_in_mm"], f_in_N=-run()["f_in_N"])
    assert set(found.values()) == {"right"}


def test_a_third_displacement_does_not_unsettle_the_two_that_are_named(path):
    columns = [*run().items()]
    columns.insert(1, ("Crosshead [mm]", run()["x_in_mm"] + 3.0))
    write_csv(path, columns)
    assert set(verdicts(path, {n: n for n in CHANNELS}).values()) == {"right"}
    columns = [(n if n != "x_out_mm" else "LVDT [mm]", v) for n, v in columns]
    judged = verdicts(write_csv(path, columns), {n: n for n in CHANNELS if n != "x_out_mm"})
    assert (judged["x_in_mm"], judged["x_out_mm"]) == ("right", "open")


def test_half_a_loop_tells_no_ends(path):
    write_csv(path, [(n, v[:300]) for n, v in zip(NUMBERED, run().values(), strict=True)])
    open_ = {c.name for c in propose([path]).channels if c.certainty == "open"}
    assert open_ == set(CHANNELS[1:])


STEMS = {
    "time_s": ["time", "t", "Zeit", ""],
    "x_in_mm": ["x_in", "Input position", "encoder", "Turntable", "Weg Antrieb", ""],
    "x_out_mm": ["x_out", "Output position", "LVDT", "Tip", "Weg Abtrieb", ""],
    "f_in_N": ["f_in", "Proximal tension", "Force 1", "Kraft Eingang", "Cell A", ""],
    "f_out_N": ["f_out", "Distal tension", "Force 2", "Kraft Ausgang", "Cell B", ""],
}


@FEWER
@given(data=st.data())
def test_no_order_and_no_mixture_of_names_is_guessed_wrong(tmp_path_factory, data):
    kept = data.draw(st.permutations(CHANNELS))[: data.draw(st.integers(2, 5))]
    names = []
    for channel in kept:
        stem = data.draw(st.sampled_from(STEMS[channel]))
        unit = data.draw(st.sampled_from(["", f"[{channel.rsplit('_', 1)[1]}]"]))
        names.append(f"{stem} {unit}".strip())
    columns = [(name, run()[channel]) for name, channel in zip(names, kept, strict=True)]
    path = write_csv(tmp_path_factory.mktemp("f") / "a.csv", columns)
    sources = [n if n and names.count(n) == 1 else i for i, n in enumerate(names, start=1)]
    assert "wrong" not in verdicts(path, dict(zip(kept, sources, strict=True))).values()


def public(name):
    folder = Path(os.environ.get("TSAS_DATA", REPOSITORY / ".." / "shared" / "data")) / name
    if not folder.is_dir():
        pytest.skip(f"no public recordings in {folder}: set TSAS_DATA, see docs/ingest.md")
    return sorted(path for path in folder.rglob("*") if path.suffix in (".TXT", ".json"))


@pytest.mark.parametrize(("name", "at_least"), [("mis-tool", 4), ("friction-damper", 1)])
def test_of_public_recordings_nothing_is_guessed_wrong(name, at_least):
    truth = read_map(MAPS / f"{name}.toml").columns
    for path in public(name):
        found = {c.name: c.entry for c in propose([path]).channels if c.entry["source"] != "?"}
        assert set(found) <= set(truth)
        assert len(found) >= at_least
        for channel, entry in found.items():
            assert entry["source"] == truth[channel].source
            assert entry.get("sign", 1) in ("?", truth[channel].sign)
            assert channel != "time_s" or entry["unit"] in ("?", truth[channel].unit)


def test_a_motor_position_without_a_unit_is_that_of_the_drive(path):
    names = {"time_s": "Time [s]", "x_in_mm": "Motor position", "x_out_mm": "Knob position"}
    assert sources(write_run(path, **names)).items() >= names.items()
    assert "motor_angle_rad" not in sources(path)
    columns = [(name, run()[channel]) for channel, name in names.items()]
    write_csv(path, [*columns, ("Spool position", run()["x_in_mm"])])
    angle = {"motor_angle_rad": "Motor position", "x_in_mm": "Spool position"}
    assert sources(path).items() >= angle.items()
