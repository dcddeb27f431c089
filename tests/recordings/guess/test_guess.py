import os
import tomllib
from itertools import permutations
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from tests.recordings.guess.rig_files import CHANNELS, in_unit, run, verdicts, write_csv
from tests.recordings.readers.matlab_files import controldesk, numbers, save_73, struct
from tsas_cli.commands.common import show
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.guess.text import map_text, tables
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.recordings.writing import write_parquet
from tsas_cli.support.errors import InputError

REPOSITORY = Path(__file__).parents[3]
MAPS = REPOSITORY / "datasets" / "maps"
UNITS = ("s", "mm", "mm", "N", "N")

# Names and units in the order of CHANNELS.
LABS = {
    "ours": (CHANNELS, UNITS),
    "readme": (
        ("Time [ms]", "Turntable [deg]", "Load [mm]", "Cell drive [lbf]", "Cell load [N]"),
        ("ms", "deg", "mm", "lbf", "N"),
    ),
    "short": (("t (s)", "xin (mm)", "xout (mm)", "Fin (N)", "Fout (N)"), UNITS),
    "proximal": (
        ("Timestamp_ms", "pos_prox_mm", "pos_dist_mm", "tension_proximal_N", "tension_distal_N"),
        ("ms", "mm", "mm", "N", "N"),
    ),
    "tensions": (("time_s", "x_in_mm", "x_out_mm", "T_in [N]", "T_out [N]"), UNITS),
    "masters": (
        ("Time [s]", "Master position [in]", "Slave position [in]", "Master force [kgf]",
         "Slave force [kgf]"),
        ("s", "in", "in", "kgf", "kgf"),
    ),
    "cells": (
        ("Elapsed time [us]", "Input displacement [cm]", "Tip displacement [um]",
         "Load cell input [N]", "Load cell output [N]"),
        ("us", "cm", "um", "N", "N"),
    ),
    "torques": (
        ("Time (s)", "Drive angle (rad)", "Output angle (rad)", "Drive torque [N.m]",
         "Output torque [N.m]"),
        ("s", "rad", "rad", "N.m", "N.m"),
    ),
    "german": (
        ("Zeit [ms]", "Antriebsweg [mm]", "Abtriebsweg [mm]", "Antriebskraft [N]",
         "Abtriebskraft [N]"),
        ("ms", "mm", "mm", "N", "N"),
    ),
    "winkel": (
        ("Zeit [s]", "Winkel Antrieb [Grad]", "Weg Ausgang [mm]", "Zugkraft Eingang [kN]",
         "Zugkraft Ausgang [kN]"),
        ("s", "Grad", "mm", "kN", "kN"),
    ),
    "french": (
        ("Temps [s]", "Déplacement entrée [mm]", "Déplacement sortie [mm]", "Effort entrée [N]",
         "Effort sortie [N]"),
        UNITS,
    ),
    "chinese": (("时间 [s]", "输入位移 [mm]", "输出位移 [mm]", "输入力 [N]", "输出力 [N]"), UNITS),
    "camel": (("TimeMs", "DrivePos", "LoadPos", "DriveForce", "LoadForce"), UNITS),
}  # fmt: skip


def columns_of(lab):
    names, units = LABS[lab]
    pairs = zip(CHANNELS, names, units, strict=True)
    return [(name, in_unit(channel, unit)) for channel, name, unit in pairs]


@pytest.mark.parametrize("lab", LABS)
def test_the_names_of_many_labs_are_understood(tmp_path, lab):
    path = write_csv(tmp_path / "a.csv", columns_of(lab))
    judged = verdicts(path, dict(zip(CHANNELS, LABS[lab][0], strict=True)))
    expected = dict.fromkeys(CHANNELS, "right")
    if lab == "camel":  # no units: the clock's is told by its steps, the others are asked for
        expected = dict.fromkeys(CHANNELS, "open") | {"time_s": "right"}
    assert judged == expected


def test_a_row_of_units_a_decimal_comma_a_preamble_and_an_old_encoding(tmp_path):
    rows = ["Prüfbericht Nr. 7", "Prüfer: Müller", "", "Zeit;Weg Antrieb;Kraft Antrieb;Kraft Last"]
    rows.append("ms;µm;N;N")
    values = zip(*(run()[n] for n in ("time_s", "x_in_mm", "f_in_N", "f_out_N")), strict=True)
    for t, x, f, g in values:
        rows.append(f"{1e3 * t:.1f};{1e3 * x:.0f};{f:.2f};{g:.2f}".replace(".", ","))
    path = tmp_path / "a.txt"
    path.write_bytes("\r\n".join(rows).encode("cp1252"))
    truth = dict(
        zip(
            ("time_s", "x_in_mm", "f_in_N", "f_out_N"),
            ("Zeit", "Weg Antrieb", "Kraft Antrieb", "Kraft Last"),
            strict=True,
        )
    )
    proposal = propose([path])
    assert proposal.read["encoding"][0] == "cp1252"
    assert proposal.read["skip_lines"][0] in (1, 2, 3)
    assert {c.name: c.entry["source"] for c in proposal.channels} == truth
    assert proposal.questions == {}


@pytest.mark.parametrize(
    ("channels", "names", "asked"),
    [
        (("time_s", "x_in_mm", "f_out_N"), ("t [s]", "drive [mm]", "cell out [N]"), "f_in_N"),
        (("time_s", "x_out_mm", "f_in_N"), ("t [s]", "tip [mm]", "cell in [N]"), "x_in_mm"),
        (("time_s", "x_in_mm", "x_out_mm"), ("t [s]", "motor [rpm]", "drive [mm]"), None),
    ],
)
def test_x_in_or_f_in_that_no_column_is_left_for_is_asked(tmp_path, channels, names, asked):
    """But for f_in where a drive alone was recorded."""
    values = run()
    path = tmp_path / "a.csv"
    write_csv(path, [(name, values[c]) for c, name in zip(channels, names, strict=True)])
    proposal = propose([path])
    if asked is None:
        assert "f_in_N" not in {channel.name for channel in proposal.channels}
        return
    assert "delete this table" in proposal.questions[f"columns.{asked}.source"]
    assert proposal.is_a_recording


def save_parquet(path):
    write_parquet(path, pa.table(run()))


def save_parquet_of_another_tool(path):
    names = [f"{n.rsplit('_', 1)[0]} [{n.rsplit('_', 1)[1]}]" for n in CHANNELS]
    pq.write_table(pa.table(dict(zip(names, run().values(), strict=True))), path)


def save_json(path):
    import json

    content = {
        "rig": "bench",
        "log": {"columns": CHANNELS, "rows": np.transpose([*run().values()]).tolist()},
    }
    path.write_text(json.dumps(content))


def save_mat(path):
    savemat(path, {"gains": np.arange(3.0), "log": run()})


def save_mat_73(path):
    def build(file):
        group = struct(file, "log")
        for name, values in run().items():
            numbers(group, name, values)

    save_73(path, build)


def save_capture(path):
    clock, *channels = run().items()
    listed = [(f'"{n}"', values, n.rsplit("_", 1)[1], 1) for n, values in channels]
    savemat(path, {"capture": controldesk([clock[1]], listed)})


def save_mdf(path):
    clock, *channels = run().items()
    with MDF(version="4.10") as file:
        file.append([Signal(values, clock[1], name=n[:-2]) for n, values in channels[2:]])
        other = clock[1] + 1e-4
        file.append([Signal(values, other, name=n[:-3], unit="mm") for n, values in channels[:2]])
        file.save(path, overwrite=True)


def _parts(name, source):
    return name.rsplit("_", 1) if "{1}" in source else [name]


@pytest.mark.parametrize(
    ("suffix", "save", "source", "open_"),
    [
        (".parquet", save_parquet, "{}", 0),
        (".parquet", save_parquet_of_another_tool, "{0} [{1}]", 0),
        (".json", save_json, "{}", 0),
        (".mat", save_mat, "log.{}", 0),
        (".mat", save_mat_73, "log.{}", 0),
        (".mat", save_capture, "{}", 0),
        (".mf4", save_mdf, None, 2),
    ],
)
def test_every_format_is_opened(tmp_path, suffix, save, source, open_):
    path = tmp_path / f"a{suffix}"
    save(path)
    proposal = propose([path])
    sources = {c.name: c.entry["source"] for c in proposal.channels}
    if source:
        at = {name: source.format(*_parts(name, source)) for name in CHANNELS}
        if save is save_capture:
            at["time_s"] = "time"
        assert sources == at
    else:
        assert sources["f_out_N"] == "f_out"
        assert sources["time_s"] == "time"
        assert proposal.read["resample"][0] is True
    assert len(proposal.questions) == open_


@pytest.mark.parametrize("other", [1, 2, 3, 4])
def test_a_time_that_is_none_is_not_believed(tmp_path, other):
    names = ["time", "x_in", "x_out", "f_in", "f_out"]
    names[0], names[other] = names[other], names[0]
    path = write_csv(tmp_path / "a.csv", list(zip(names, run().values(), strict=True)))
    judged = verdicts(path, dict(zip(CHANNELS, names, strict=True)))
    assert "wrong" not in judged.values()
    assert judged["time_s"] == "open"


def test_exchanged_load_cells_leave_the_displacements_as_they_are(tmp_path):
    names = ["time [s]", "x_in [mm]", "x_out [mm]", "f_out [N]", "f_in [N]"]
    path = write_csv(tmp_path / "a.csv", list(zip(names, run().values(), strict=True)))
    judged = verdicts(path, dict(zip(CHANNELS, names, strict=True)))
    assert judged == dict.fromkeys(CHANNELS, "right") | {"f_in_N": "open", "f_out_N": "open"}


@pytest.mark.parametrize("order", list(permutations(range(4)))[1:])
@pytest.mark.parametrize("units", [["[mm]", "[mm]", "[N]", "[N]"], [""] * 4])
def test_no_exchange_of_names_is_believed(tmp_path, order, units):
    if order == (0, 3, 2, 1) and not any(units):
        pytest.skip("displacement and tension of a spring look alike: without units names decide")
    stems = [("x_in", "x_out", "f_in", "f_out")[i] for i in order]
    names = ["time [s]", *(f"{s} {u}".strip() for s, u in zip(stems, units, strict=True))]
    path = write_csv(tmp_path / "a.csv", list(zip(names, run().values(), strict=True)))
    assert "wrong" not in verdicts(path, dict(zip(CHANNELS, names, strict=True))).values()


@pytest.mark.parametrize("names", [["A", "B", "C", "D", "E"], [""] * 5])
def test_without_names_only_the_clock_is_told(tmp_path, names):
    path = write_csv(tmp_path / "a.csv", list(zip(names, run().values(), strict=True)))
    truth = {n: name or i + 1 for i, (n, name) in enumerate(zip(CHANNELS, names, strict=True))}
    assert verdicts(path, truth) == dict.fromkeys(CHANNELS, "open") | {"time_s": "right"}
    text = map_text(propose([path]))
    assert "is nearer to the drive than" in text


def test_units_alone_and_the_motion_tell_the_ends(tmp_path):
    names = ["1 [s]", "2 [mm]", "3 [mm]", "4 [N]", "5 [N]"]
    path = write_csv(tmp_path / "a.csv", list(zip(names, run().values(), strict=True)))
    truth = dict(zip(CHANNELS, names, strict=True))
    assert verdicts(path, truth) == dict.fromkeys(CHANNELS, "right")
    assert {c.certainty for c in propose([path]).channels} == {"sure", "likely"}


def test_signs_that_are_turned_are_turned_back(tmp_path):
    turned = [-1 if n in ("x_in_mm", "f_in_N") else 1 for n in CHANNELS]
    columns = [(n, s * run()[n]) for n, s in zip(CHANNELS, turned, strict=True)]
    path = write_csv(tmp_path / "a.csv", columns)
    assert set(verdicts(path, {n: n for n in CHANNELS}).values()) == {"right"}


def test_a_third_displacement_does_not_unsettle_the_two_that_are_named(tmp_path):
    columns = [(n, run()[n]) for n in CHANNELS]
    columns.insert(1, ("Crosshead [mm]", run()["x_in_mm"] + 3.0))
    path = write_csv(tmp_path / "a.csv", columns)
    assert set(verdicts(path, {n: n for n in CHANNELS}).values()) == {"right"}
    columns = [(n if n != "x_out_mm" else "LVDT [mm]", v) for n, v in columns]
    judged = verdicts(write_csv(path, columns), {n: n for n in CHANNELS if n != "x_out_mm"})
    assert (judged["x_in_mm"], judged["x_out_mm"]) == ("right", "open")


def test_half_a_loop_tells_no_ends(tmp_path):
    names = ["1 [s]", "2 [mm]", "3 [mm]", "4 [N]", "5 [N]"]
    columns = [(n, v[:300]) for n, v in zip(names, run().values(), strict=True)]
    path = write_csv(tmp_path / "a.csv", columns)
    proposal = propose([path])
    assert {c.name for c in proposal.channels if c.certainty == "open"} == set(CHANNELS[1:])


@pytest.mark.parametrize(
    ("name", "factor", "expected"),
    [
        ("time", 1.0, {"unit": "s"}),
        ("t", 1e3, {"unit": "ms"}),
        ("Time [ms]", 1.0, {"unit": "?"}),  # 100 kHz in all of 12 ms
        ("Time [s]", 1e6, {"unit": "?"}),
        ("Sample", 100.0, None),
    ],
)
def test_the_unit_of_the_clock_has_to_make_sense(tmp_path, name, factor, expected):
    columns = [(name, run()["time_s"] * factor), ("x_in_mm", run()["x_in_mm"])]
    path = write_csv(tmp_path / "a.csv", [*columns, ("f_in_N", run()["f_in_N"])])
    (clock, *_) = propose([path]).channels
    if expected is None:
        assert clock.entry == {"rate_Hz": "?"}
    else:
        assert {key: clock.entry[key] for key in expected} == expected


STEMS = {
    "time_s": ["time", "t", "Zeit", ""],
    "x_in_mm": ["x_in", "Input position", "encoder", "Turntable", "Weg Antrieb", ""],
    "x_out_mm": ["x_out", "Output position", "LVDT", "Tip", "Weg Abtrieb", ""],
    "f_in_N": ["f_in", "Proximal tension", "Force 1", "Kraft Eingang", "Cell A", ""],
    "f_out_N": ["f_out", "Distal tension", "Force 2", "Kraft Ausgang", "Cell B", ""],
}


@settings(
    max_examples=settings.default.max_examples * 6 // 10,
    suppress_health_check=list(HealthCheck),
)
@given(data=st.data())
def test_no_order_and_no_mixture_of_names_is_guessed_wrong(tmp_path_factory, data):
    kept = data.draw(st.permutations(CHANNELS))[: data.draw(st.integers(2, 5))]
    columns, truth = [], {}
    for i, channel in enumerate(kept):
        stem = data.draw(st.sampled_from(STEMS[channel]))
        unit = data.draw(st.sampled_from(["", f"[{channel.rsplit('_', 1)[1]}]"]))
        name = f"{stem} {unit}".strip()
        columns.append((name, run()[channel]))
        truth[channel] = name or i + 1
    for i, (channel, (name, _)) in enumerate(zip(kept, columns, strict=True)):
        if [n for n, _ in columns].count(name) > 1:
            truth[channel] = i + 1
    path = write_csv(tmp_path_factory.mktemp("f") / "a.csv", columns)
    if not any(name for name, _ in columns):
        truth = {channel: i + 1 for i, channel in enumerate(kept)}
    assert "wrong" not in verdicts(path, truth).values()


def test_the_map_is_whole_or_says_what_it_asks(tmp_path, tsas):
    write_csv(tmp_path / "a.csv", columns_of("readme"))
    done = tsas("ingest", "a.csv", "--guess", "--out", "m.toml", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    with pytest.raises(InputError, match=r"1 question is open: columns.x_in_mm.pulley_radius_mm"):
        read_map(tmp_path / "m.toml")
    text = (tmp_path / "m.toml").read_text()
    (tmp_path / "m.toml").write_text(text.replace('"?"\n', "27.1\n"))
    done = tsas("ingest", "a.csv", "--map", "m.toml", "--out", "d", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("page", ["docs/ingest.md", "README.md"])
def test_the_pages_show_what_is_printed(tmp_path, capsys, page):
    path = write_csv(tmp_path / "bend180.csv", columns_of("readme"))
    proposal = propose([path])
    show({}, tables(proposal, "bench.toml"), quiet=False, as_json=False)
    shown = (REPOSITORY / page).read_text(encoding="utf-8")
    assert capsys.readouterr().out.strip() in shown
    if page == "docs/ingest.md":
        text = map_text(proposal)
        begin, end = text.index("[columns.x_in_mm]"), text.index('pulley_radius_mm = "?"')
        assert text[begin:end] in shown


def test_every_key_of_a_map_has_a_comment_above_or_beside_it(tmp_path):
    text = map_text(propose([write_csv(tmp_path / "a.csv", columns_of("readme"))]))
    for block in text.split("\n\n"):
        lines = block.splitlines()
        for i, line in enumerate(lines):
            if " = " in line and not line.startswith("#"):
                assert "#" in line or any(above.startswith("#") for above in lines[:i])


def test_what_a_file_name_says_is_a_pattern_that_works(tmp_path):
    path = write_csv(tmp_path / "L785.4_bend180_F0=25.csv", columns_of("ours"))
    text = map_text(propose([path]))
    begin = text.index("# [run.from_file_name]")
    answered = text[:begin] + text[begin:].replace("# ", "")
    (tmp_path / "m.toml").write_text(answered)
    mapping = read_map(tmp_path / "m.toml")
    found = mapping.run.from_file_name.pattern.search(f"raw/{path.name}").groupdict()
    assert found == {"length": "785.4", "bend": "180", "preload": "25"}
    assert mapping.run.conditions["total_bend_rad"].unit == "deg"


def test_files_that_do_not_go_with_the_others_are_named(tmp_path):
    write_csv(tmp_path / "a.csv", columns_of("ours"))
    (tmp_path / "notes.txt").write_text("bent by hand\n")
    write_csv(tmp_path / "b.csv", columns_of("ours"))
    proposal = propose([tmp_path / "notes.txt", tmp_path / "a.csv", tmp_path / "b.csv"])
    assert proposal.looked_at.path.name == "a.csv"
    assert [path.name for path in proposal.different] == ["notes.txt"]
    assert proposal.read["files"][0] == "*.csv"


def test_a_wrong_call_is_one_line(tmp_path, tsas):
    write_csv(tmp_path / "a.csv", columns_of("ours"))
    for words, message in [
        (("--out", "d"), "--map is missing"),
        (("--guess", "--map", "m"), "leave one of them out"),
    ]:
        done = tsas("ingest", "a.csv", *words, cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert message in done.stderr


def test_text_gaps_and_what_rests_are_left_out_with_the_reason(tmp_path):
    names = ("time [s]", "x_in [mm]", "f_in [N]", "Operator", "Nothing", "Idle [mm]")
    rows = [f"{t},{x},{f},Jo,,4" for t, x, f in zip(*(run()[n][::4] for n in _SOME), strict=True)]
    (tmp_path / "a.csv").write_text("\n".join([",".join(names), *rows]))
    proposal = propose([tmp_path / "a.csv"])
    assert [c.entry["source"] for c in proposal.channels] == list(names[:3])
    assert proposal.looked_at.left_out == {"Operator": "column Operator holds 'Jo'"}
    assert set(proposal.not_taken) == {"Nothing", "Idle [mm]"}
    text = map_text(proposal)
    assert "Operator cannot be used" in text
    assert '# extra = ["Nothing", "Idle [mm]"]' in text


_SOME = ("time_s", "x_in_mm", "f_in_N")


@settings(
    max_examples=settings.default.max_examples * 6 // 10,
    suppress_health_check=list(HealthCheck),
)
@given(data=st.data())
def test_any_numbers_make_a_map_and_no_defect(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("f") / "a.csv"
    names = data.draw(
        st.lists(
            st.sampled_from(
                ["time", "t [s]", "x_in", "F [N]", "F [mm]", "x [V]", "sample", "é?", ""]
            ),
            min_size=1,
            max_size=6,
        )
    )
    cell = st.sampled_from(["", "0", "1", "-1", "1e300", "inf", "nan", "-0.0", "3.5"])
    few = st.integers(1, 80)
    rows = [[data.draw(cell) for _ in names] for _ in range(data.draw(few))]
    path.write_text("\n".join(",".join(row) for row in [names, *rows]) + "\n")
    try:
        text = map_text(propose([path]))
    except InputError:
        return
    tomllib.loads(text)


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


@pytest.mark.parametrize(
    ("step", "first", "unit"),
    [
        (1_000_000, 0, "ns"),  # 1 kHz; in microseconds it were 1 Hz
        (10_000_000, 1_772_532_000_000_000_000, "ns"),  # since 1970
        (50_000, 1_772_532_000_000_000, "us"),  # 20 Hz; as nanoseconds it were 20 kHz, in 1970
        (10, 1_772_532_000_000, "ms"),
        (50_000, 0, "?"),
    ],
)
def test_the_unit_of_a_clock_follows_from_its_steps_and_its_date(tmp_path, step, first, unit):
    stamps = [str(first + i * step) for i in range(run()["time_s"].size)]
    rows = zip(stamps, run()["x_in_mm"], run()["f_in_N"], strict=True)
    lines = [f"{t},{x:.7g},{f:.7g}" for t, x, f in rows]
    (tmp_path / "a.csv").write_text("\n".join(["stamp,x_in [mm],f_in [N]", *lines]))
    time = propose([tmp_path / "a.csv"]).channels[0]
    assert time.entry["unit"] == unit


def test_title_lines_padded_with_delimiters_are_skipped(tmp_path):
    path = write_csv(tmp_path / "a.csv", [(n, run()[n]) for n in CHANNELS], delimiter=";")
    path.write_text("Bench 42;;;\n;;;\nrecorded by;M;;\n" + path.read_text())
    proposal = propose([path])
    assert proposal.read["skip_lines"][0] == 3
    assert {c.name for c in proposal.channels} >= {"time_s", "x_in_mm", "f_in_N"}


def test_a_column_that_looks_like_a_missing_channel_is_asked_about(tmp_path):
    r = run()
    angle = np.degrees(r["x_in_mm"] / 27.1)
    columns = [("t_s", r["time_s"]), ("motor_deg", angle), ("handle_in", r["x_out_mm"] / 25.4)]
    path = write_csv(tmp_path / "a.csv", [*columns, ("loadcell_motor_lbf", r["f_in_N"] / 4.448)])
    proposal = propose([path])
    asked = proposal.questions
    assert '"handle_in", "motor_deg"? An angle needs' in asked["columns.x_in_mm.source"]
    assert '"handle_in"' in asked["columns.x_out_mm.source"]
    assert "No question is open" not in map_text(proposal)


def test_thousands_are_asked_about_and_no_column_is_left_out(tmp_path):
    columns = [(n, run()[n] * (1000 if n == "f_in_N" else 1)) for n in CHANNELS]
    path = write_csv(tmp_path / "a.csv", columns, delimiter=";")
    name, *rows = path.read_text().splitlines()
    cells = [row.split(";") for row in rows]
    rows = [";".join([*c[:3], f"{float(c[3]):,.2f}", *c[4:]]) for c in cells]
    path.write_text("\n".join([name, *rows]))
    proposal = propose([path])
    assert "are thousands separated in it?" in proposal.questions["read.decimal"]
    assert "f_in_N" in {c.name for c in proposal.channels}
    assert not proposal.looked_at.left_out
