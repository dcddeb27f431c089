"""A long recording is checked in stretches: what is wrong in one is found, and nothing else."""

from itertools import product

import numpy as np
import pytest

from tests.recordings.quality.bench import LOAD, Bench, columns
from tsas_cli.recordings import pieces
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.quality import OVERLAP, RUN_CHECKS, check_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.recordings import Run, write_dataset

PARTS = 4
NOISY = {"rate_Hz": 200.0, "noise_mm": 0.02, "noise_N": 0.3}


@pytest.fixture
def check(tmp_path, monkeypatch):
    """Return a function that checks a run in stretches of a quarter of its rows."""

    def checked(measured, load="spring", parts=PARTS):
        sheet = {"load_stiffness_N_per_mm": LOAD}
        runs = [Run("a", measured, {"load": load})]
        folder = write_dataset(tmp_path / "dataset", runs, data_sheet=sheet)
        rows = measured["time_s"].size
        monkeypatch.setattr(pieces, "MOST_ROWS", rows if parts == 1 else rows // parts)
        return check_dataset(read_dataset(folder))

    return checked


def summary(report):
    return [(f.code, f.column, f.severity) for f in report.findings if f.severity != "note"]


@pytest.mark.parametrize(
    ("shape", "load", "parts"),
    [
        *product(("sine", "triangle", "dwells", "nested"), ("spring", "force"), [10]),
        *(("nested", load, 3) for load in ("spring", "displacement")),
    ],
)
def test_nothing_is_reported_about_an_ordinary_recording(check, shape, load, parts):
    ordinary = columns(Bench(shape=shape, load=load, seed=3, **NOISY))
    assert summary(check(ordinary, load, parts)) == []


@pytest.fixture(params=[(16.0, 200.0), (160.0, 20.0)], ids=["few strokes", "many strokes"])
def measured(request):
    """Return strokes that are longer or shorter than a stretch."""
    duration_s, rate_Hz = request.param
    return columns(Bench(duration_s=duration_s, rate_Hz=rate_Hz, seed=5))


def backwards(measured):
    measured["time_s"][700] = measured["time_s"][690]


def without_rows(measured):
    for name, values in measured.items():
        measured[name] = np.delete(values, slice(900, 930))


def stuck(measured):
    n = measured["time_s"].size
    measured["x_out_mm"][n // 2 : 5 * n // 8] = measured["x_out_mm"][n // 2]


def set_rows(name, rows, value):
    return lambda measured: np.put(measured[name], rows, value)


HARM = {
    "exchanged": lambda m: m.update(f_in_N=m["f_out_N"], f_out_N=m["f_in_N"]),
    "clipped": lambda m: m.update(f_in_N=np.minimum(m["f_in_N"], 0.9 * m["f_in_N"].max())),
    "stuck": stuck,
    "turned": lambda m: m.update(x_out_mm=-m["x_out_mm"]),
    "empty": set_rows("f_out_N", range(200, 260), np.nan),
    "inches": lambda m: m.update(x_out_mm=m["x_out_mm"] / 25.4),
    "backwards": backwards,
    "without rows": without_rows,
    "wild": set_rows("f_in_N", [1000, 3000], [1e4, 3.4e38]),
}


@pytest.mark.parametrize("harm", HARM.values(), ids=HARM)
def test_what_is_found_in_the_whole_is_found_in_its_stretches(check, measured, harm):
    harm(measured)
    whole, parts = check(measured, parts=1), check(measured)
    assert summary(whole)
    assert summary(parts) == summary(whole)


@pytest.mark.parametrize("harm", ["stuck", "clipped"])
def test_what_is_not_checked_is_so_beside_a_finding_of_the_same_check(check, harm):
    measured = columns(Bench(load="force", seed=5, **NOISY))
    HARM[harm](measured)
    whole, parts = check(measured, "force", parts=1), check(measured, "force")
    assert summary(parts) == summary(whole) != []
    known = {(one.code, one.reason) for one in whole.not_checked}
    assert known
    assert known == {(one.code, one.reason) for one in parts.not_checked}


def test_rows_are_counted_from_the_beginning_of_the_run(check, measured):
    backwards(measured)
    assert "first at row 700 " in check(measured).findings[0].sentence


def test_a_fault_in_one_stretch_is_reported_with_its_rows(check, measured):
    without_rows(measured)
    size = measured["time_s"].size // PARTS
    first = size - size // OVERLAP
    (finding,) = check(measured).findings
    assert f"rows {first} to {first + size - 1}; in 1 of {PARTS + 1} stretches" in finding.sentence


def test_strokes_longer_than_a_stretch_are_strokes(check):
    slow = columns(Bench(shape="sine", seed=1, **NOISY))
    rows = np.linspace(0, slow["time_s"].size - 1, 8 * slow["time_s"].size)
    rng = np.random.default_rng(1)
    stretched = {n: np.interp(rows, np.arange(v.size), v) for n, v in slow.items()}
    stretched = {n: v + 0.02 * rng.standard_normal(v.size) for n, v in stretched.items()}
    stretched["time_s"] = np.arange(rows.size) / 200.0
    assert summary(check(stretched, parts=30)) == []


def test_a_drive_that_hardly_turns_back_is_told(check):
    time_s = np.arange(4000) / 200.0
    rng = np.random.default_rng(2)
    x = 10.0 * time_s / time_s[-1] + 0.01 * rng.standard_normal(time_s.size)
    report = check({"time_s": time_s, "x_in_mm": x, "f_in_N": 20.0 + x})
    assert ("few-reversals", "x_in_mm", "warning") in summary(report)


def test_what_cannot_be_told_is_reported_once(check, measured):
    del measured["f_out_N"]
    report = check(measured)
    codes = [c.code for c in report.not_checked]
    assert "exchanged" in codes
    assert len(codes) == len(set(codes)) <= len(RUN_CHECKS)


def test_a_long_run_without_an_output_is_refused(check, measured):
    with pytest.raises(InputError, match="an input and an output column are needed"):
        check({name: measured[name] for name in ("time_s", "x_in_mm")})
