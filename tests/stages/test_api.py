"""`import tsas_cli as tsas`: what a notebook gets is what the commands write."""

import json
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tests.commands.test_ingest import CSV, MAP
from tests.counted import Counted
from tests.rigs import dataset_of, recorded
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.files import json_text
from tsas_studies.challenge.rig.tendon import Rig

SHORT = {"settings": {"reference": {"duration_s": 3.0}}, "seeds": 2}
RIG = Rig(friction_coefficient=0.16, proximal_length_mm=150.0, distal_length_mm=60.0, cells=60)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return dataset_of(RIG, tmp_path_factory.mktemp("api") / "dataset", a=recorded(RIG, 25.0))


@pytest.fixture(scope="module")
def calibrated(folder):
    counted = Counted()
    result = tsas.calibrate(folder, out=folder.parent / "calibrate", step=counted)
    assert counted.all_of(least=20)  # effects are looked at, since the nominal model misses
    return result


@pytest.fixture(scope="module")
def checked(folder):
    counted = Counted()
    result = tsas.check(folder, out=folder.parent / "check", step=counted)
    assert counted.all_of(least=1)
    assert len(result.findings) == len(result.summary["findings"])
    assert len(result.not_checked) == len(result.summary["not_checked"])
    return result


@pytest.fixture(scope="module")
def tracked(folder):
    """Return what a short loop does, as each call with these options has to."""
    result = tsas.track(controllers=["pid"], out=folder.parent / "track", **SHORT)
    again = tsas.track(controllers="pid", **SHORT)
    assert again.summary["results"] == result.summary["results"]
    assert again.out is None
    assert "→" not in repr(again).splitlines()[0]
    return result


@pytest.fixture(scope="module")
def simulated(folder, calibrated):
    return tsas.simulate(folder, model=calibrated.model, out=folder.parent / "simulate")


@pytest.fixture(scope="module")
def diagnosed(folder):
    counted = Counted()
    result = tsas.diagnose(str(folder), out=str(folder.parent / "diagnose"), step=counted)
    assert counted.all_of(least=30)  # a search says what lies ahead
    return result


def written(folder, name):
    return json.loads((folder.parent / name).read_text(encoding="utf-8"))


def as_written(content):
    """Return a summary as JSON holds it: no tuples, no numpy, null for what is not finite."""
    return json.loads(json_text(content))


def test_a_dataset_gives_its_runs_as_arrays_and_tables(folder):
    data = tsas.read(folder)
    assert isinstance(data, Dataset)
    run, file = data["a"], pq.read_table(folder / "runs" / "a.parquet")
    assert list(run.columns) == file.column_names
    for name, values in run.columns.items():
        assert values.dtype == np.float64
        np.testing.assert_array_equal(values, file[name].to_numpy())
    frame = run.frame()
    assert frame.index.name == "time_s"
    np.testing.assert_array_equal(frame["f_in_N"], run.columns["f_in_N"])
    assert repr(data).endswith("dataset: a")
    assert repr(run).startswith(f"run a: {file.num_rows} rows, ")


def test_chosen_runs_are_those_that_count(folder):
    assert [run.id for run in tsas.read(folder, runs=["a"]).runs] == ["a"]
    with pytest.raises(tsas.InputError, match="known are a"):
        tsas.read(folder, runs="A")


@pytest.mark.parametrize(
    ("result", "file"),
    [
        ("calibrated", "calibrate/calibration.json"),
        ("simulated", "simulate/simulation.json"),
        ("diagnosed", "diagnose/diagnosis.json"),
        ("checked", "check/check.json"),
        ("tracked", "track/tracking.json"),
    ],
)
def test_the_summary_is_what_is_written(request, folder, result, file):
    assert as_written(request.getfixturevalue(result).summary) == written(folder, file)


@pytest.mark.parametrize(
    ("result", "file"),
    [("calibrated", "calibrate/model.toml"), ("diagnosed", "diagnose/model-extended.toml")],
)
def test_the_model_is_what_is_written(request, folder, result, file):
    model, again = request.getfixturevalue(result).model, read_model(folder.parent / file)
    order = {"key": lambda e: (e.name, e.run or "")}
    assert sorted(again.estimates, **order) == sorted(model.estimates, **order)


@pytest.mark.parametrize(("result", "run"), [("simulated", "a"), ("tracked", "pid-undisturbed")])
def test_channels_are_what_is_written(request, result, run):
    found = request.getfixturevalue(result)
    file = pq.read_table(found.out / "runs" / f"{run}.parquet")
    assert isinstance(found[run], Recording)
    assert list(found[run].columns) == file.column_names
    for name, values in found[run].columns.items():
        assert values.shape == (file.num_rows,)
        np.testing.assert_array_equal(values, file[name].to_numpy())
    with pytest.raises(tsas.InputError, match="there is no run 'z'"):
        found["z"]


def test_a_model_in_hand_and_its_file_give_the_same_in_memory_and_written(folder, simulated):
    held = tsas.simulate(folder, model=folder.parent / "calibrate")
    assert list(held.runs) == list(simulated.runs)
    for name, values in held["a"].columns.items():
        np.testing.assert_array_equal(simulated["a"].columns[name], values)
    assert held.summary["runs"] == simulated.summary["runs"]
    assert simulated.summary["model"] == {"file": "in memory"}
    assert held.summary["model"]["file"] == "model.toml"
    with pytest.raises(tsas.InputError, match="there is no run 'z'"):
        held["z"]


def test_the_command_prints_and_writes_the_same(done, folder, simulated, tmp_path):
    model = folder.parent / "calibrate" / "model.toml"
    printed = done("simulate", folder, "--model", model, "--out", tmp_path / "out")
    title, *lines = printed.rstrip().splitlines()
    assert title == f"slip model → {tmp_path / 'out'}"
    assert lines == repr(simulated).splitlines()[1:]
    ours = folder.parent / "simulate" / "runs" / "a.parquet"
    assert ours.read_bytes() == (tmp_path / "out" / "runs" / "a.parquet").read_bytes()


def test_a_value_comes_with_what_is_known_of_it(calibrated):
    friction = calibrated.model.estimate("friction_coefficient", run="a")
    assert friction.unit == "1"
    assert friction.interval_low < friction.value < friction.interval_high
    assert calibrated.model.value("friction_coefficient") == friction.value
    table = calibrated.model.frame().set_index("name")
    assert table.loc["friction_coefficient", "interval_high"] == friction.interval_high
    with pytest.raises(tsas.InputError, match="did you mean friction_coefficient"):
        calibrated.model.estimate("friction_coeficient")


def test_the_cause_is_named_with_its_gain(diagnosed):
    assert diagnosed.verdict == diagnosed.summary["verdict"]
    effects = {cause.effect for cause in diagnosed.causes}
    effects |= {rival for cause in diagnosed.causes for rival in cause.rivals}
    assert "free_tendon" in effects
    assert all(cause.gain_percent > 50.0 for cause in diagnosed.causes)
    text = repr(diagnosed)
    assert diagnosed.reason in text
    assert f"Next: {diagnosed.next_experiment}" in text


def test_a_notebook_shows_tables_and_escapes_names(simulated):
    html = simulated._repr_html_()
    assert html.count("<table ") == 1
    assert "<th" in html
    assert f">{simulated.summary['runs']['a']['channels']['f_in_N']['rmse']:.4g}<" in html

    evil = replace(simulated, summary=simulated.summary | {"notes": ["<script>alert(1)</script>"]})
    assert "<script>" not in evil._repr_html_()


def test_nothing_is_written_unasked(folder, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    before = sorted(folder.rglob("*"))
    tsas.check(folder)
    tsas.simulate(folder)
    assert list(tmp_path.iterdir()) == []
    assert sorted(folder.rglob("*")) == before


def test_files_become_a_dataset(tmp_path):
    (tmp_path / "map.toml").write_text(MAP)
    (tmp_path / "a.csv").write_text(CSV)
    counted, call = Counted(), {"map": tmp_path / "map.toml", "out": tmp_path / "out"}
    result = tsas.ingest(tmp_path / "a.csv", **call, step=counted)
    assert counted.all_of(least=2)
    assert result.runs[0].rows == 3
    run = tsas.read(tmp_path / "out")["a"]
    np.testing.assert_array_equal(run.columns["f_in_N"], [25.0, np.nan, 27.0])
    np.testing.assert_array_equal(run.columns["x_in_mm"], result.dataset["a"].columns["x_in_mm"])
    with pytest.raises(tsas.InputError, match="already exists"):
        tsas.ingest([tmp_path / "a.csv"], **call)


def test_two_models_in_memory_are_compared(calibrated):
    """Half the friction: a half less, and nothing else differs."""
    friction = calibrated.model.estimate("friction_coefficient")
    half = Estimate(friction.name, 0.5 * friction.value, friction.unit, "given")
    halved = Model((half,)).over(calibrated.model)
    pairs = tsas.compare(calibrated.model, halved).record.parameters
    ratios = {pair.name: pair.b.value / pair.a.value for pair in pairs if pair.a and pair.b}
    assert ratios.pop("friction_coefficient") == 0.5
    assert set(ratios.values()) == {1.0}


def test_a_table_of_parameters_is_of_the_runs_that_were_taken():
    """The model has the data sheet's values for the others too."""
    result = tsas.calibrate("datasets/paper-groups", runs=["a", "d"])
    (rows,) = [rows for title, _, rows in result.tables() if title.startswith("parameters")]
    assert {run for _, run, *_ in rows} == {"all", "a", "d"}
