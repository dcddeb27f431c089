"""A run that is too long for memory: simulated as a whole one is, thinned for the fit."""

import tracemalloc

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tsas_cli.identification.long_runs import open_long
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.prepared import prepare
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.recordings import pieces
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.recordings import DATA_SHEET

ROWS, PIECE = 12_000, 2500
ANSWERS = ("f_in_N", "f_out_N", "x_out_mm")


def entry(load="spring"):
    conditions = {"sheath_length_mm": 785.4, "total_bend_rad": 3.1416, "preload_N": 25.0}
    return Run(id="a", file="runs/a.parquet", sha256="0" * 64, load=load, **conditions)


def written(folder, columns, run):
    manifest = Manifest(format=1, name="long", kind="simulated", rig=DATA_SHEET, run=(run,))
    folder.mkdir(exist_ok=True)
    table = pa.table({n: pa.array(v, from_pandas=True) for n, v in columns.items()})
    write_dataset(folder, manifest, {"a": table})
    return folder


def recorded(rows=ROWS):
    """Return what the sensors record of nested strokes."""
    rng = np.random.default_rng(1)
    time_s = 5.0 + np.arange(rows) / 100.0
    x = 6.0 + 5.0 * np.sin(0.7 * time_s) + 1.5 * np.sin(2.3 * time_s)
    noisy = {"x_in_mm": x + 0.002 * rng.standard_normal(rows)}
    for name, values in answered(time_s, x).items():
        noise = 0.002 if name == "x_out_mm" else 0.05
        noisy[name] = values + noise * rng.standard_normal(rows)
    return {"time_s": time_s, **noisy}


def answered(time_s, x):
    manifest = Manifest(format=1, name="long", kind="simulated", rig=DATA_SHEET, run=(entry(),))
    true = simulate(data_sheet(manifest).rig(entry()), DriveInput(x, time_s=time_s - time_s[0]))
    return {name: getattr(true, name) for name in ANSWERS}


def without_noise(load, rows=6000):
    """Return ramps in binary fractions, whose third differences are nothing at all."""
    rng = np.random.default_rng(1)
    time_s = np.arange(rows) / 128.0

    def ramps(period_s):
        up = np.abs((time_s / period_s) % 2.0 - 1.0)
        return 8.0 * up + time_s / 512.0  # no level is taken twice

    columns = {"time_s": time_s, "x_in_mm": 4.0 + ramps(4.0)}
    for name, values in answered(time_s, columns["x_in_mm"]).items():
        columns[name] = values + 0.01 * rng.standard_normal(rows)
    if load != "spring":
        columns["f_out_N" if load == "force" else "x_out_mm"] = 16.0 + ramps(8.0)
    return columns


@pytest.fixture
def long(monkeypatch):
    """Make recordings of more than `PIECE` rows long ones."""

    return lambda rows=PIECE: monkeypatch.setattr(pieces, "MOST_ROWS", rows)


def answers(dataset, out, **how):
    result = tsas.simulate(dataset, out=out, **how)
    return result.summary, pq.read_table(out / "runs" / "a.parquet").to_pandas()


@pytest.mark.parametrize("load", ["spring", "force", "displacement"])
@pytest.mark.parametrize("how", [{}, {"dynamics": "static"}, {"nodes": 12}])
def test_a_drive_without_noise_gives_the_answer_of_the_whole(tmp_path, long, load, how):
    if load != "spring" and "dynamics" in how:
        pytest.skip("the static model knows a spring only")
    columns = without_noise(load)
    columns["x_in_mm"][700:760] = np.nan
    columns["x_in_mm"][2480:2510] = np.nan
    columns["f_in_N"][3000:3100] = np.nan
    dataset = written(tmp_path / "d", columns, entry(load))
    whole, expected = answers(dataset, tmp_path / "whole", **how)
    long()
    found, answer = answers(dataset, tmp_path / "pieces", **how)
    assert list(answer.columns) == list(expected.columns)
    np.testing.assert_allclose(answer, expected, rtol=1e-9, atol=1e-9)
    assert answer["f_in_N"].isna().sum() == 90
    told, all_told = found["runs"]["a"], whole["runs"]["a"]
    for key in ("solver", "start", "samples", "slack_samples", "unconverged_samples", "notes"):
        assert told[key] == all_told[key]
    for name, channel in all_told["channels"].items():
        assert told["channels"][name]["rmse"] == pytest.approx(channel["rmse"])
        assert told["channels"][name]["samples"] == channel["samples"]
        assert told["channels"][name]["noise"] == pytest.approx(channel["noise"], rel=0.1)


def test_a_noisy_drive_gives_an_answer_as_good_as_that_of_the_whole(tmp_path, long):
    dataset = written(tmp_path / "d", recorded(), entry())
    whole, _ = answers(dataset, tmp_path / "whole")
    long()
    found, _ = answers(dataset, tmp_path / "pieces")
    for name, channel in whole["runs"]["a"]["channels"].items():
        assert found["runs"]["a"]["channels"][name]["rmse"] < 1.1 * channel["rmse"]
    assert len(found["segments"]["a"]) > 0.9 * len(whole["segments"]["a"])


def test_a_fit_sees_even_samples_and_every_reversal(tmp_path, long):
    dataset = read_dataset(written(tmp_path / "d", recorded(), entry()))
    whole = prepare(dataset["a"])
    long()
    run = open_long(dataset, dataset.runs[0], None).prepared()
    assert run.every == 5
    assert ROWS / 5 < run.time_s.size < ROWS / 5 + 20 + whole.conditioned["x_in_mm"].reversals.size
    assert np.isin(whole.time_s[::5], run.time_s).all()
    seen, all_seen = run.conditioned["x_in_mm"], whole.conditioned["x_in_mm"]
    assert seen.reversals.size == all_seen.reversals.size
    turned = run.time_s[seen.reversals] - whole.time_s[all_seen.reversals]
    assert np.abs(turned).max() < 0.05
    assert run.noise["f_in_N"] == pytest.approx(whole.noise["f_in_N"], rel=0.05)
    assert run.drive.start_f_in_N == pytest.approx(whole.drive.start_f_in_N)


def test_the_calibration_finds_the_truth_and_says_what_it_has_seen(tmp_path, long):
    dataset = written(tmp_path / "d", recorded(), entry())
    long()
    result = tsas.calibrate(dataset)
    told = {e.name: e for e in result.model.estimates}
    truth = {"friction_coefficient": 0.125, "load_stiffness_N_per_mm": 1.579, "preload_N": 25.0}
    for name, true in truth.items():
        assert told[name].value == pytest.approx(true, rel=2e-3)
        assert told[name].interval_low < true < told[name].interval_high
    said = f"Run a has {ROWS} samples: the fit uses one in 5 of them, and those at reversals"
    assert any(sentence.startswith(said) for sentence in result.summary["cannot_tell"])
    assert said in "\n".join(result.sentences())


def test_a_run_of_as_many_rows_as_a_piece_is_read_whole(tmp_path, long):
    dataset = read_dataset(written(tmp_path / "d", recorded(rows=3000), entry()))
    long(3000)
    assert open_long(dataset, dataset.runs[0], None) is None
    assert tsas.calibrate(dataset).summary["cannot_tell"][0].startswith("x_out_zero_mm")


def test_what_belongs_to_the_run_can_be_fitted_first(tmp_path, long):
    columns = recorded()
    columns["x_in_mm"] = columns["x_in_mm"] + 0.7
    dataset = written(tmp_path / "d", columns, entry())
    long()
    result = tsas.simulate(dataset, out=tmp_path / "s", fit_own=True)
    assert result.summary["runs"]["a"]["channels"]["f_out_N"]["rmse"] < 0.06


@pytest.mark.parametrize(
    ("how", "factors", "said"),
    [
        ({"dynamics": "lugre"}, {}, "12000 samples are too many to be simulated with the dynamic"),
        ({"out": None}, {}, "12000 samples are too many to be returned in memory; give a folder"),
        ({}, {"x_in_mm": np.nan}, "no numbers|is empty"),
        ({}, dict.fromkeys(ANSWERS, np.nan), "nothing to compare a model with"),
    ],
)
def test_what_a_long_run_cannot_have_is_refused(tmp_path, long, how, factors, said):
    columns = {n: factors.get(n, 1.0) * v for n, v in recorded().items()}
    dataset = written(tmp_path / "d", columns, entry())
    long()
    with pytest.raises(InputError, match=said):
        tsas.simulate(dataset, **({"out": tmp_path / "s"} | how))


def test_a_channel_of_the_wrong_sign_is_refused(tmp_path, long):
    columns = recorded()
    dataset = written(tmp_path / "d", columns | {"x_out_mm": -columns["x_out_mm"]}, entry())
    long()
    with pytest.raises(InputError, match="x_out_mm moves opposite to x_in_mm"):
        tsas.calibrate(dataset)


@pytest.fixture(scope="module")
def short_and_long(tmp_path_factory):
    """Return two datasets, the second one three times as long as the first."""
    folder = tmp_path_factory.mktemp("grown")
    return [written(folder / f"{rows}", recorded(rows=rows), entry()) for rows in (4_000, 12_000)]


@pytest.mark.parametrize("stage", ["check", "simulate", "prepare"])
def test_memory_does_not_grow_with_the_recording(tmp_path, long, short_and_long, stage):
    long()
    peaks = []
    for dataset in short_and_long:
        tracemalloc.start()
        if stage == "check":
            tsas.check(dataset)
        elif stage == "simulate":
            tsas.simulate(dataset, out=tmp_path / dataset.name)
        else:
            opened = read_dataset(dataset)
            open_long(opened, opened.runs[0], None).prepared()
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < peaks[0] + 0.3 * 8_000 * 5 * 8
