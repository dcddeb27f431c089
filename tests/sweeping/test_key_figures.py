"""The key figures of a diagnosis, and tables of rows that do not all hold the same."""

from types import SimpleNamespace

import pyarrow.parquet as pq

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.records.calibration import CalibrationFile, ChannelError, NominalFit
from tsas_cli.records.diagnosis import DiagnosisFile, HeldOut, NamedCause
from tsas_cli.sweeping.key_figures import estimates, figures
from tsas_cli.sweeping.sweep import printed, write_rows

FRICTION = Estimate("friction_coefficient", 0.12, "1", "fitted", None, 0.005, 0.11, 0.13)
GIVEN = Estimate("tendon_stiffness_N", 5e4, "N", "data sheet")
OF_A_RUN = Estimate("preload_N", 25.0, "N", "fitted", "a", 0.1, 24.8, 25.2)
MODEL = Model((FRICTION, GIVEN, OF_A_RUN))


def test_a_diagnosis_gives_verdict_causes_gains_errors_and_what_was_fitted():
    gain = {"gain_percent": 40.0, "gain_interval_percent": (30.0, 50.0)}
    cause = NamedCause(effect="backlash", rivals=("drive_ripple",), **gain)
    channels = {"f_in_N": HeldOut(rmse_before=0.9, rmse_after=0.1)}
    record = DiagnosisFile.model_construct(verdict="ambiguous", named=[cause], channels=channels)
    diagnosis = SimpleNamespace(record=record, model=MODEL)
    assert figures("diagnose", diagnosis) == {
        "verdict": "ambiguous",
        "causes": "backlash",
        "rivals": "drive_ripple",
        "gain_percent_backlash": 40.0,
        "gain_percent_backlash_low": 30.0,
        "gain_percent_backlash_high": 50.0,
        "rmse_before_f_in_N": 0.9,
        "rmse_after_f_in_N": 0.1,
        "fitted_friction_coefficient": 0.12,
        "fitted_friction_coefficient_low": 0.11,
        "fitted_friction_coefficient_high": 0.13,
        "fitted_friction_coefficient_at_bound": False,
    }
    assert [e["run"] for e in estimates("diagnose", diagnosis)] == [None, None, "a"]
    assert estimates("simulate", diagnosis) == []


def test_errors_of_runs_are_pooled_by_their_squares():
    channels = {
        run: {"f_in_N": ChannelError(rmse=rmse, noise=0.1)}
        for run, rmse in (("a", 3.0), ("b", 4.0))
    }
    record = CalibrationFile.model_construct(fit=NominalFit(converged=False), channels=channels)
    found = figures("calibrate", SimpleNamespace(record=record, model=Model(())))
    assert found == {"converged": False, "rmse_f_in_N": 12.5**0.5}


def test_rows_need_not_hold_the_same(tmp_path):
    rows = [{"task": "a", "nodes": 10, "error": None}, {"task": "b", "codes": "x", "error": "no"}]
    write_rows(tmp_path / "t.parquet", rows)
    table = pq.read_table(tmp_path / "t.parquet")
    assert table.to_pylist() == [
        {"task": "a", "nodes": 10, "error": None, "codes": None},
        {"task": "b", "nodes": None, "error": "no", "codes": "x"},
    ]
    write_rows(tmp_path / "m.parquet", [{"reference": 1}, {"reference": "sine"}])
    assert pq.read_table(tmp_path / "m.parquet")["reference"].to_pylist() == ["1", "sine"]


def test_what_is_printed_counts_words_and_spans_numbers_and_names_failures():
    rows = [
        {"task": f"t{n}", "state": "done", "nodes": n, "verdict": verdict, "rmse_f_in_N": float(n)}
        for n, verdict in enumerate(["named", "named", "sufficient"])
    ]
    rows[2]["fitted_x_at_bound"] = True
    rows.append({"task": "t3", "state": "failed", "nodes": 3, "error": "no such file"})
    spans, words, failed = printed(rows, ["nodes"], "title")
    assert spans[0] == "title"
    assert spans[2] == [
        ("rmse_f_in_N", "3", "0", "1", "2"),
        ("fitted_x_at_bound", "1", "1 yes", "", "0 no"),
    ]
    assert words[1:] == (("verdict", "tasks"), [("named", "2"), ("sufficient", "1")])
    assert failed == ("failed 1", ("input", "error"), [("nodes=3", "no such file")])
    row = {"task": "t", "dataset": "rigs/a", "run": "x", "state": "failed", "error": "no"}
    assert printed([row], [], "title")[-1][2] == [("rigs/a, x", "no")]
    many = [{"task": str(n), "state": "failed", "error": "no"} for n in range(30)]
    title, _, shown = printed(many, [], "title")[-1]
    assert (title, len(shown)) == ("failed 30, the first 20", 20)
