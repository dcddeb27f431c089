"""Streams of made folders, read back and held against the files that they were made from."""

import json
from datetime import datetime
from itertools import pairwise

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.reporting import made_folders as by_hand
from tests.reporting import made_loops
from tests.reporting.made_diagnoses import LAW
from tests.reporting.stream.streams import make_diagnosed, stream
from tsas_cli.recordings.run_files import RunColumns
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.names import PHASES, role_of_phase
from tsas_cli.reporting.stream.recorder import ROWS
from tsas_cli.reporting.stream.stream import plain_text
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.recordings import Run, write_dataset

SAMPLES = 2 * ROWS + 100


def overview(found: dict) -> str:
    return found["/about/overview"].static["TextDocument:text"][0]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    dataset = by_hand.make_dataset(folder / "dataset", samples=SAMPLES)
    by_hand.make_simulation(dataset, folder / "simulate")
    by_hand.make_calibration(dataset, folder / "calibrate")
    make_diagnosed(dataset, folder / "diagnose")
    return folder


@pytest.fixture(scope="module")
def found(made):
    return stream(made, *(made / name for name in ("calibrate", "simulate", "diagnose")))


def column(path, name):
    return pq.read_table(path).column(name).to_numpy()


def test_every_sample_is_there_at_the_nanosecond_of_the_parquet(made, found):
    for number, run in enumerate("ab"):
        recorded = made / "dataset" / "runs" / f"{number}.parquet"
        time_ns = np.round(column(recorded, "time_s") * 1e9).astype(np.int64)
        for name in ("x_in_mm", "f_in_N", "f_out_N"):
            line = found[f"/run/{run}/{name}/measured"]
            assert (line.at() == time_ns).all()
            assert (line.scalars == column(recorded, name)).all()
            assert line.chunks == [ROWS, ROWS, 100]


def test_measured_and_simulated_are_not_swapped(made, found):
    for key, stage, name in (
        ("simulated", "simulate", "f_in_N"),
        ("model", "diagnose", "f_in_nominal_N"),
        ("model_extended", "diagnose", "f_in_N"),
    ):
        measured = column(made / "dataset" / "runs" / "0.parquet", "f_in_N")
        answer = column(made / stage / "runs" / "a.parquet", name)
        assert not (measured == answer).all()
        assert (found[f"/run/a/f_in_N/{key}"].scalars == answer).all()
        residual = found[f"/run/a/f_in_N/residual/{key}"]
        assert (residual.scalars == measured - answer).all()
        assert (residual.at() == found["/run/a/f_in_N/measured"].at()).all()


def test_what_was_not_simulated_has_no_answer_and_what_drives_a_model_no_residual(made, tmp_path):
    found = stream(tmp_path, made / "diagnose")
    assert "/run/a/f_in_N/model" in found
    assert "/run/a/f_out_N/model" not in found
    assert "/run/a/f_in_N/simulated" not in found
    assert "/run/a/x_in_mm/model_input" in found
    assert "/run/a/x_in_mm/residual/model_input" not in found


@pytest.mark.parametrize("laws", [[], [LAW]])
def test_the_extended_model_is_there_where_a_law_extends_it(made, tmp_path, laws):
    folder = make_diagnosed(made / "dataset", tmp_path / "d", "unexplained", laws=laws)
    assert ("/run/a/f_in_N/model_extended" in stream(tmp_path, folder)) == bool(laws)


def test_series_are_named_and_coloured_as_in_the_report(found):
    named = {
        "measured": ("measured", "measured"),
        "simulated": ("simulated", "simulated"),
        "model": ("nominal model", "before"),
        "model_extended": ("extended model", "after"),
    }
    for key, (label, role) in named.items():
        static = found[f"/run/a/f_in_N/{key}"].static
        assert static["SeriesLines:names"] == [label]
        assert static["SeriesLines:colors"] == [dark(role)]


def test_phases_begin_when_the_file_says_in_the_colours_of_the_report(made, found):
    said = json.loads((made / "calibrate" / "calibration.json").read_text())["segments"]["a"]
    phase = found["/run/a/phase"]
    begun = [(round(s["start_s"] * 1e9), s["phase"]) for s in said]
    ends = [(round(s["end_s"] * 1e9), "") for s in said]
    states = [row[0] for row in phase.rows["StateChange:state"]]
    shown = list(zip(phase.at().tolist(), states, strict=True))
    assert [state for state in shown if state[1]] == begun
    assert set(shown) - set(begun) <= set(ends)
    assert shown[-1] == ends[-1]
    values, colours = (phase.static[f"StateConfiguration:{what}"] for what in ("values", "colors"))
    assert dict(zip(values, colours, strict=True)) == {
        key: dark(role_of_phase(key)) for key in PHASES
    }


def test_the_loops_stand_in_their_colours_and_the_points_run_along(made, found):
    recorded = made / "dataset/runs/0.parquet"
    x, measured = column(recorded, "x_in_mm"), column(recorded, "f_in_N")
    known = np.round(column(recorded, "time_s") * 1e9).astype(np.int64)
    loop = found["/run/a/f_in_N/loop/measured"].static
    shades = {dark(role_of_phase(key)) for key, number in PHASES.items() if number}
    assert set(loop["LineStrips2D:colors"]) == shades
    strips = [np.array(strip) for strip in loop["LineStrips2D:strips"]]
    assert all((one[-1] == other[0]).all() for one, other in pairwise(strips))
    scale = []
    for key, values in (
        ("measured", measured),
        ("model", column(made / "diagnose/runs/a.parquet", "f_in_nominal_N")),
    ):
        now = found[f"/run/a/f_in_N/loop/{key}/now"]
        places = np.array([row[0] for row in now.rows["Points2D:positions"]])
        at = np.searchsorted(known, now.at())
        assert np.corrcoef(places[:, 0], x[at])[0, 1] == pytest.approx(1.0)
        assert np.corrcoef(places[:, 1], values[at])[0, 1] == pytest.approx(-1.0)
        scale.append(np.polyfit(values[at], places[:, 1], 1))
    assert scale[0] == pytest.approx(scale[1], rel=1e-3)


def test_ticks_stand_where_their_values_are(found):
    loop = found["/run/a/f_in_N/loop/names"].static
    places, labels = np.array(loop["Points2D:positions"]), loop["Points2D:labels"]
    assert labels[:9] == ["0", "5", "10", "15", "20", "20", "40", "60", "80"]
    assert labels[9:] == [
        "displacement of the tendon at the drive [mm]",
        "tension at the drive [N]",
    ]
    assert np.ptp(np.diff(places[:5, 0])) < 1e-6 < np.diff(places[:5, 0]).min()
    assert np.ptp(np.diff(places[5:9, 1])) < 1e-6
    assert np.diff(places[5:9, 1]).max() < 0.0  # y points downwards


def test_a_gap_stays_a_gap_and_no_loop_bridges_it(tmp_path):
    time_s = np.arange(200) / 100
    f_in = np.where((time_s > 0.5) & (time_s < 0.6), np.nan, 20 + time_s)
    table = {"time_s": time_s, "x_in_mm": 5 * time_s, "f_in_N": f_in}
    found = stream(tmp_path, write_dataset(tmp_path / "d", [Run("<script>", table)]))
    line = found["/run/\\<script\\>/f_in_N/measured"]
    assert line.scalars.size == 200
    assert (np.isnan(line.scalars) == np.isnan(f_in)).all()
    loop = found["/run/\\<script\\>/f_in_N/loop/measured"].static["LineStrips2D:strips"]
    assert [len(strip) for strip in loop] == [51, 140]
    assert found["/run/\\<script\\>/f_in_N/loop/measured/now"].at().size == 191


def test_a_start_puts_all_of_a_run_on_the_session(tmp_path):
    told = {"started": datetime(2026, 3, 2, 9, 30)}  # noqa: DTZ001 # as a manifest may say it
    table = dict.fromkeys(("time_s", "x_in_mm", "f_in_N"), np.arange(50) / 10)
    runs = [Run(name, table, told) for name in "ab"]
    found = stream(tmp_path, write_dataset(tmp_path / "d", runs))
    moving = [entity for path, entity in found.items() if entity.times]
    assert len(moving) == 2 * (2 + 1)  # two series and a point of each run
    for entity in moving:
        began = np.datetime64("2026-03-02T09:30:00", "ns").astype(np.int64)
        assert (entity.at("session") - began == entity.at()).all()


def test_faults_stand_where_they_begin_with_their_severity(tmp_path):
    dataset = by_hand.make_dataset(tmp_path / "dataset")
    finding = {"code": "clipped", "run": "b", "sentence": "f_in_N is clipped"}
    late = finding | {"severity": "error", "first_s": 1.25}
    whole = finding | {"severity": "note", "first_s": None, "sentence": "rate is low"}
    found = stream(tmp_path, by_hand.make_check(dataset, tmp_path / "check", [late, whole]))
    faults = found["/run/b/faults"]
    assert faults.at().tolist() == [0, 1_250_000_000]
    assert [row[0] for row in faults.rows["TextLog:level"]] == ["INFO", "ERROR"]
    assert "clipped: f\\_in" not in faults.rows["TextLog:text"][1][0]
    assert "f_in_N is clipped" in faults.rows["TextLog:text"][1][0]
    assert "/run/a/faults" not in found


def test_what_the_checks_cannot_read_is_told_and_not_shown(tmp_path):
    dataset = by_hand.make_dataset(tmp_path / "dataset")
    finding = {"code": "unreadable", "run": "a", "sentence": "a.parquet is empty"}
    check = by_hand.make_check(dataset, tmp_path / "check", [finding | {"severity": "error"}])
    (dataset / "runs" / "0.parquet").write_bytes(b"")
    found = stream(tmp_path, check)
    assert "/run/b/f_in_N/measured" in found
    assert not any(path.startswith("/run/a/") for path in found)
    assert "- error, run a, unreadable: a.parquet is empty" in overview(found)


def test_a_closed_loop_shows_its_error_and_what_the_controller_remembers(tmp_path):
    """The made force is missed by 1 N undisturbed, and by 2 N disturbed."""
    found = stream(tmp_path, made_loops.make_tracking(tmp_path / "tracked"))
    for condition, missed_N in (("undisturbed", 1.0), ("disturbed", 2.0)):
        run = f"/run/pid-{condition}"
        assert found[f"{run}/tracking_error_N"].scalars == pytest.approx(missed_N)
        wanted, true = (found[f"{run}/f_out_N/{key}"].scalars for key in ("wanted", "true"))
        assert wanted - true == pytest.approx(missed_N)
        assert found[f"{run}/f_out_N/true"].static["SeriesLines:names"] == ["pid"]
    adapted = found["/run/adaptive-sliding-mode-disturbed/phi1_rpm_s3_per_mm"]
    assert set(adapted.scalars) == {0.005, 0.1}
    assert "/run/pid-disturbed/phi1_rpm_s3_per_mm" not in found
    assert r"pid\-disturbed: the motor is at its \<limit\>" in overview(found)


def test_the_overview_says_what_was_found_and_escapes_what_files_hold(made, tmp_path):
    said = overview(stream(tmp_path, made / "diagnose"))
    assert said.startswith("# bench")
    assert "**Cause found: normalised residual" in said
    assert "lower: Tendon outside the sheath**" in said
    assert "A free length of tendon" in said
    assert "Next: Record the same motion" in said
    assert "- tension at the drive: 0.910 → 0.110 N (9.1 → 1.1 × noise level)" in said


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("<script>", r"\<script\>"),
        ("[x](javascript:y)", r"\[x\]\(javascript:y\)"),
        ("a|b", r"a\|b"),
        ("f_in_N *now*", r"f\_in\_N \*now\*"),
        ("two\nlines", r"two\\nlines"),
        ("`a`", r"\`a\`"),
        ("plain 1.5 N", "plain 1.5 N"),
    ],
)
def test_nothing_in_a_name_is_read_as_markdown(name, shown):
    assert plain_text(name) == shown


def test_each_column_is_read_once(made, tmp_path, monkeypatch):
    read_columns = []
    real = RunColumns.read

    def counted(self, name):
        read_columns.append((self.run.id, name))
        return real(self, name)

    monkeypatch.setattr(RunColumns, "read", counted)
    stream(tmp_path, made / "calibrate")
    names = ("time_s", "x_in_mm", "f_in_N", "f_out_N")
    assert sorted(read_columns) == sorted((run, name) for run in "ab" for name in names)


def test_only_runs_that_a_stage_took_are_shown(made, tmp_path):
    folder = by_hand.make_simulation(made / "dataset", made / "some")
    with by_hand.edited(folder / "simulation.json") as content:
        content["chosen"] = ["b"]
    found = stream(tmp_path, folder)
    assert "/run/b/f_in_N/simulated" in found
    assert not any(path.startswith("/run/a/") for path in found)


def test_answers_to_another_recording_are_refused_and_nothing_is_left(tmp_path):
    dataset = by_hand.make_dataset(tmp_path / "dataset")
    folder = by_hand.make_simulation(dataset, tmp_path / "simulate")
    path = folder / "runs" / "b.parquet"
    pq.write_table(pq.read_table(path).slice(0, 100), path)
    with pytest.raises(InputError, match=r"b\.parquet: 100 rows"):
        stream(tmp_path, folder)
    assert not (tmp_path / "s.rrd").exists()
