import numpy as np
import pyarrow.parquet as pq
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.recording_faults import (
    RECORDING_FAULTS,
    RECORDING_SIZES,
    drawn_recording,
)
from tsas_studies.challenge.rig.motions import through
from tsas_studies.challenge.rig.recording import FAULTS, recorded_with
from tsas_studies.challenge.rig.recording.recorded import CHANNELS
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.tendon import Rig

MOTION = through([2.0, 0.0])


def test_the_product_reads_what_the_rig_writes(tmp_path):
    rig = Rig(preload_N=31.0)
    columns = record(rig, MOTION, seed=4)
    columns["f_in_N"][7] = np.nan
    write_dataset(tmp_path / "d", [Run("one", columns, conditions(rig))], license="CC0-1.0")
    dataset = read_dataset(tmp_path / "d")
    assert dataset.manifest.kind == "simulated"
    assert dataset.manifest.license == "CC0-1.0"
    assert dataset.manifest.rig.tendon_modulus_GPa == 60.0
    (recording,) = dataset
    assert recording.run.preload_N == 31.0
    assert recording.run.total_bend_rad == pytest.approx(np.pi)
    for name, values in columns.items():
        np.testing.assert_array_equal(recording.columns[name], values)


def test_units_and_gaps_are_in_the_file(tmp_path):
    columns = record(Rig(), MOTION)
    columns["f_out_N"][3] = np.nan
    write_dataset(tmp_path, [Run("one", columns)])
    table = pq.read_table(tmp_path / "runs" / "one.parquet")
    assert table.schema.field("x_out_mm").metadata == {b"unit": b"mm"}
    assert table.column("f_out_N").null_count == 1
    assert table.column("f_in_N").null_count == 0


TIME = np.arange(2001) * 0.01
RUNS = {
    name: Run(
        name,
        {
            "time_s": TIME,
            "x_in_mm": 10.0 - 10.0 * np.cos(k * TIME),
            "x_out_mm": 9.5 - 9.5 * np.cos(k * TIME - 0.1),
            "f_in_N": 45.0 - 25.0 * np.cos(k * TIME),
            "f_out_N": 40.0 - 15.0 * np.cos(k * TIME - 0.1),
        },
        {"total_bend_rad": 3.0, "sheath_length_mm": 785.0},
    )
    for k, name in enumerate("abcd", 1)
}


def rng():
    return np.random.default_rng(0)


def said(run):
    return [*(run.columns[name].tobytes() for name in ("time_s", *CHANNELS)), run.conditions]


@pytest.mark.parametrize("size", RECORDING_SIZES)
@pytest.mark.parametrize("fault", RECORDING_FAULTS)
def test_each_fault_changes_the_runs_that_it_names(fault, size):
    known, values = RECORDING_FAULTS[fault], drawn_recording(fault, size, 3)
    sound = recorded_with(RUNS, "scaled", {"channels": (), "factor": 1.0}, rng())
    found = recorded_with(RUNS, known.function, values, rng())
    changed = {name for name in RUNS if said(found[name]) != said(sound[name])}
    assert changed == ({values["run"]} if values.get("run") else set(RUNS))
    channels = values.get("channels", (values.get("channel", CHANNELS[0]),))
    assert all(np.isfinite(found[run].columns[name]).all() for run in RUNS for name in channels)
    assert known.function in FAULTS
    assert known.right


def test_a_gain_an_offset_and_a_clock_of_one_run():
    at = {"run": "b", "channel": "f_in_N"}
    old = RUNS["b"].columns["f_in_N"]
    more = FAULTS["run_gain"](RUNS, rng(), **at, gain=1.03, since=0.5)["b"].columns["f_in_N"]
    np.testing.assert_allclose(more / old, np.where(TIME >= 10.0, 1.03, 1.0))
    bump = FAULTS["run_offset"](RUNS, rng(), **at, offset=2.0, since=0.25, until=0.5)
    shift = bump["b"].columns["f_in_N"] - old
    np.testing.assert_allclose(shift, 2.0 * ((TIME >= 5.0) & (TIME <= 10.0)))
    late = FAULTS["run_clock"](RUNS, rng(), run="b", channels=("f_in_N",), late_s=0.1)
    np.testing.assert_allclose(late["b"].columns["f_in_N"][10:], old[:-10], atol=1e-9)


def test_lost_and_repeated_rows_leave_even_times():
    lost = FAULTS["lost_samples"](RUNS, rng(), lost_s=0.05, times=1, run="a")["a"]
    assert lost.time_s.size == TIME.size - 5
    np.testing.assert_allclose(np.diff(lost.time_s), 0.01)
    assert np.abs(np.diff(lost.columns["x_in_mm"])).max() > 0.2
    twice = FAULTS["repeated_buffers"](RUNS, rng(), buffer_s=0.1, times=1)["a"]
    assert twice.time_s.size == TIME.size + 10


def test_filters_and_amplifiers():
    noise = rng().standard_normal(TIME.size)
    runs = {"a": RUNS["a"].having(f_in_N=noise)}
    smooth = FAULTS["zero_phase_low_pass"](runs, rng(), channels=("f_in_N",), cut_Hz=5.0)
    assert smooth["a"].columns["f_in_N"].std() < 0.4
    flat = {"a": RUNS["a"].having(f_in_N=np.full(TIME.size, 40.0))}
    passed = FAULTS["ac_coupled"](flat, rng(), channels=("f_in_N",), time_s=5.0)["a"]
    assert passed.columns["f_in_N"][0] == 40.0
    assert passed.columns["f_in_N"][500] == pytest.approx(40.0 / np.e, rel=0.01)
    held = FAULTS["held"](RUNS, rng(), channels=("x_in_mm",), rate_Hz=20.0)["a"]
    assert np.unique(held.columns["x_in_mm"]).size <= TIME.size // 5 + 1
