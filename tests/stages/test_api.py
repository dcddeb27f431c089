"""`import tsas_cli as tsas`: what a notebook gets is what the commands write."""

import inspect
import json
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tests.counted import Counted
from tests.test_app import HEAVY
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model_file import read_model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.stages.diagnose import DiagnosisResult
from tsas_cli.stages.identify_harmonic_drive import DriveResult
from tsas_cli.stages.plan import PlanResult
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

RIG = Rig(friction_coefficient=0.16, proximal_length_mm=150.0, distal_length_mm=60.0, cells=60)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    recorded = record(RIG, sine(rate_Hz=200.0), sensors=Sensors(rate_Hz=100.0))
    where = tmp_path_factory.mktemp("api") / "dataset"
    return write_dataset(where, [Run("a", recorded, conditions(RIG))])


@pytest.fixture(scope="module")
def calibrated(folder):
    counted = Counted()
    result = tsas.calibrate(folder, out=folder.parent / "calibrate", step=counted)
    assert counted.all_of(least=20)  # effects are looked at, since the nominal model misses
    return result


@pytest.fixture(scope="module")
def simulated(folder, calibrated):
    return tsas.simulate(folder, model=calibrated.model, out=folder.parent / "simulate")


@pytest.fixture(scope="module")
def counted():
    return Counted()


@pytest.fixture(scope="module")
def diagnosed(folder, counted):
    return tsas.diagnose(str(folder), out=str(folder.parent / "diagnose"), step=counted)


def written(folder, name):
    return json.loads((folder.parent / name).read_text(encoding="utf-8"))


def as_written(content):
    """Return a summary as JSON holds it: no tuples, no numpy, null for what is not finite."""
    from tsas_cli.support.files import json_text

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
    with pytest.raises(tsas.InputError, match="there is no run 'b'"):
        tsas.read(folder)["b"]


@pytest.mark.parametrize(
    ("result", "file"),
    [
        ("calibrated", "calibrate/calibration.json"),
        ("simulated", "simulate/simulation.json"),
        ("diagnosed", "diagnose/diagnosis.json"),
    ],
)
def test_the_summary_is_what_is_written(request, folder, result, file):
    assert as_written(request.getfixturevalue(result).summary) == written(folder, file)


@pytest.mark.parametrize(
    ("result", "file"),
    [("calibrated", "calibrate/model.toml"), ("diagnosed", "diagnose/model-extended.toml")],
)
def test_the_model_is_what_is_written(request, folder, result, file):
    model = request.getfixturevalue(result).model
    order = {"key": lambda e: (e.name, e.run or "")}
    assert sorted(read_model(folder.parent / file).estimates, **order) == sorted(
        model.estimates, **order
    )


def test_simulated_channels_are_what_is_written(folder, simulated):
    file = pq.read_table(folder.parent / "simulate" / "runs" / "a.parquet")
    answer = simulated["a"]
    assert isinstance(answer, Recording)
    assert list(answer.columns) == file.column_names
    for name, values in answer.columns.items():
        assert values.shape == (file.num_rows,)
        np.testing.assert_array_equal(values, file[name].to_numpy())
    error = tsas.read(folder)["a"].columns["f_in_N"] - answer.columns["f_in_N"]
    told = simulated.summary["runs"]["a"]["channels"]["f_in_N"]["rmse"]
    assert told == pytest.approx(float(np.sqrt(np.mean(error**2))))


def test_answers_are_the_same_in_memory_and_read_from_what_was_written(folder, simulated):
    held = tsas.simulate(folder, model=folder.parent / "calibrate")
    assert list(held.runs) == list(simulated.runs)
    for name, values in held["a"].columns.items():
        np.testing.assert_array_equal(simulated["a"].columns[name], values)
    for result in (held, simulated):
        with pytest.raises(tsas.InputError, match="there is no run 'z'"):
            result["z"]


def test_a_model_in_hand_and_its_file_are_the_same(folder, simulated):
    by_file = tsas.simulate(folder, model=folder.parent / "calibrate")
    assert by_file.summary["runs"] == simulated.summary["runs"]
    assert simulated.summary["model"] == {"file": "in memory"}
    assert by_file.summary["model"]["file"] == "model.toml"


def test_the_command_prints_and_writes_the_same(strict, folder, simulated, tmp_path):
    model = folder.parent / "calibrate" / "model.toml"
    call = ("simulate", folder, "--model", model, "--out", tmp_path / "out")
    done = strict(*call)
    assert (done.returncode, done.stderr) == (0, "")
    title, *lines = done.stdout.rstrip().splitlines()
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


def test_a_search_says_what_lies_ahead(diagnosed, counted):
    assert diagnosed.verdict
    assert counted.all_of(least=30)


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


SHORT = "[reference]\nduration_s = 3.0\n"


def test_tracked_runs_are_what_is_written(tmp_path):
    (tmp_path / "s.toml").write_text(SHORT)
    result = tsas.track(
        controllers=["pid"], settings=tmp_path / "s.toml", out=tmp_path / "out", seeds=2
    )
    file = pq.read_table(tmp_path / "out" / "runs" / "pid-undisturbed.parquet")
    run = result["pid-undisturbed"]
    for name in ("f_out_ref_N", "f_out_true_N", "motor_speed_rpm"):
        np.testing.assert_array_equal(run.columns[name], file[name].to_numpy())
    content = json.loads((tmp_path / "out" / "tracking.json").read_text(encoding="utf-8"))
    assert as_written(result.summary) == content
    again = tsas.track(controllers="pid", settings=tmp_path / "s.toml", seeds=2)
    assert again.summary["results"] == result.summary["results"]
    assert again.out is None
    assert "→" not in repr(again).splitlines()[0]
    with pytest.raises(tsas.InputError, match="there is no run"):
        result["pid"]


CSV = "t,x,f\n0,1,25\n0.5,2,\n1,3,27\n"
MAP = """
[dataset]
name = "bench"
[columns]
time_s = {source = "t", unit = "s"}
x_in_mm = {source = "x", unit = "mm"}
f_in_N = {source = "f", unit = "N"}
"""


def test_files_become_a_dataset(tmp_path):
    (tmp_path / "map.toml").write_text(MAP)
    (tmp_path / "a.csv").write_text(CSV)
    counted = Counted()
    result = tsas.ingest(
        tmp_path / "a.csv", map=tmp_path / "map.toml", out=tmp_path / "out", step=counted
    )
    assert counted.all_of(least=2)
    assert result.runs[0].rows == 3
    run = tsas.read(tmp_path / "out")["a"]
    np.testing.assert_array_equal(run.columns["f_in_N"], [25.0, np.nan, 27.0])
    np.testing.assert_array_equal(run.columns["x_in_mm"], result.dataset["a"].columns["x_in_mm"])
    with pytest.raises(tsas.InputError, match="already exists"):
        tsas.ingest([tmp_path / "a.csv"], map=tmp_path / "map.toml", out=tmp_path / "out")


def test_check_is_told_by_run(folder, tmp_path):
    counted = Counted()
    result = tsas.check(folder, out=tmp_path / "check", step=counted)
    assert counted.all_of(least=1)
    content = json.loads((tmp_path / "check" / "check.json").read_text(encoding="utf-8"))
    assert as_written(result.summary) == content
    assert len(content["findings"]) == len(result.findings)
    assert len(content["not_checked"]) == len(result.not_checked)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda folder: tsas.read(folder / "none"), "no dataset.toml here"),
        (lambda folder: tsas.check(folder, out=folder), "is an input, and would be"),
        (lambda folder: tsas.calibrate(folder, dynamics="static"), "expected slip or lugre"),
        (lambda folder: tsas.simulate(folder, dynamics="lugra"), "did you mean lugre"),
        (lambda folder: tsas.simulate(folder, model="none.toml"), "cannot be read"),
        (lambda folder: tsas.diagnose(folder, runs=["b"]), "there is no run 'b'"),
        (
            lambda folder: tsas.identify_harmonic_drive(folder, speed="said"),
            "measured or commanded",
        ),
        (tsas.identify_harmonic_drive, "motor_speed_rpm"),
        (lambda folder: tsas.track(controllers="p"), "unknown controller p"),
        (lambda folder: tsas.track(controllers=[]), "no controller is named"),
        (lambda folder: tsas.track(dynamics="static"), "expected slip or lugre"),
        (lambda folder: tsas.track(seeds=0), "seeds is 0; expected 1 or more"),
        (lambda folder: tsas.track(disturb="frction_coefficient=0.2"), "did you mean friction"),
        (lambda folder: tsas.close_loop(out="none", first_seed=-1), "first_seed is -1"),
        (
            lambda folder: tsas.close_loop(out="none", seeds=99_999_999_999),
            "seeds is 99999999999; expected at most 10000",
        ),
        (lambda folder: tsas.track(seeds=10_001), "seeds is 10001; expected at most 10000"),
        (lambda folder: tsas.plan(folder / "none.toml"), "cannot be read"),
        (lambda folder: tsas.report(folder.parent, out=folder.parent / "r.html"), "neither a"),
        (lambda folder: tsas.explain("backlsh"), "did you mean backlash"),
        (lambda folder: tsas.close_loop(out="none", cases=["x"]), "unknown case x"),
        (lambda folder: tsas.read(5), "5 is of type int; expected str or Path"),
        (lambda folder: tsas.read(folder)[0], "there is no run 0; known are"),
        (lambda folder: tsas.check(folder, runs=[]), "no run is chosen"),
        (lambda folder: tsas.simulate(folder, model={}), "is of type dict; expected Path or Model"),
        (lambda folder: tsas.runs("", folders=[]), "no folder or file is named"),
        (lambda folder: tsas.runs(5), "5 is of type int; expected str"),
        (lambda folder: tsas.runs("", folder, columns=5), "5 is of type int; expected str"),
        (lambda folder: tsas.runs("", folder, sort=[None]), "None is of type NoneType"),
        (lambda folder: tsas.runs("", folder, limit="x"), "'x' is of type str; expected int"),
        (lambda folder: tsas.runs("", folder, limit=1.5), "1.5 is of type float; expected int"),
        (lambda folder: tsas.explain(5), "5"),
        (lambda folder: tsas.calibrate(folder, dynamics=5), "dynamics is 5; expected slip or"),
        (lambda folder: tsas.identify_harmonic_drive(folder, speed=5), "speed is 5"),
        (lambda folder: tsas.track(seeds=[1]), "is of type list; expected int"),
        (lambda folder: tsas.track(first_seed=b"x"), "is of type bytes; expected int"),
        (lambda folder: tsas.compare("a", "b", out=5), "5 is of type int; expected Path"),
        (lambda folder: tsas.guess([]), "no folder or file is named"),
        (lambda folder: tsas.report([], out="x.html"), "no folder or file is named"),
        (lambda folder: tsas.plan([]), "no folder or file is named"),
        (lambda folder: tsas.plan([folder, folder]), "2 places are named; expected one dataset"),
        (lambda folder: tsas.track(controllers=5), "5 is of type int; expected str"),
        (lambda folder: tsas.plan(3), "3 is of type int"),
        (lambda folder: tsas.verify(3), "3 is of type int"),
        (lambda folder: tsas.ingest(3, map=4, out="x"), "is of type int"),
        (lambda folder: tsas.simulate(folder, nodes="x"), "'x' is of type str; expected int"),
        (lambda folder: tsas.simulate(folder, nodes=50.0), "50.0 is of type float; expected int"),
        (lambda folder: tsas.predict(5, folder), "5 is of type int; expected str or Path"),
        (lambda folder: tsas.compare("a", None), "None is of type NoneType; expected str or Path"),
        (lambda folder: tsas.runs("", folder, limit=True), "True is of type bool; expected int"),
        (lambda folder: tsas.read(300 * "a"), "no file can have this name"),
        (lambda folder: tsas.check(folder, out="a\0b"), "no file can have this name"),
        (lambda folder: tsas.track(settings=5000 * "a/"), "no file can have this name"),
        (lambda folder: tsas.upload(300 * "a", "s3://b/c"), "no file can have this name"),
        (lambda folder: tsas.upload("a\0b", "s3://b/c"), "no file can have this name"),
        (lambda folder: tsas.calibrate(folder, dynamics=np.zeros(2)), "expected slip or lugre"),
    ],
)
def test_a_wrong_call_is_an_input_error(folder, wrong, says):
    with pytest.raises(tsas.InputError, match=says):
        wrong(folder)


def test_two_models_in_memory_are_compared(folder):
    """Half the friction: a half less, and nothing else differs."""
    model = tsas.calibrate(folder).model
    halved = tuple(
        Estimate(e.name, 0.5 * e.value, e.unit, "given") if e.name == "friction_coefficient" else e
        for e in model.estimates
    )
    pairs = tsas.compare(model, replace(model, estimates=halved)).record.parameters
    ratios = {pair.name: pair.b.value / pair.a.value for pair in pairs if pair.a and pair.b}
    assert ratios.pop("friction_coefficient") == 0.5
    assert set(ratios.values()) == {1.0}


def test_every_name_is_there_and_explained():
    for name in tsas.__all__:
        thing = getattr(tsas, name)
        assert thing.__doc__
        assert name in dir(tsas)
        if inspect.isfunction(thing):
            told = inspect.getdoc(thing)
            assert "Returns\n-------" in told
            for parameter in inspect.signature(thing).parameters:
                assert f"\n{parameter}\n" in told
    with pytest.raises(AttributeError, match="no attribute 'nope'"):
        _ = tsas.nope


def test_the_import_is_light():
    program = "import tsas_cli as tsas, sys, json; dir(tsas); print(json.dumps(list(sys.modules)))"
    call = [sys.executable, "-c", program]
    loaded = json.loads(subprocess.run(call, capture_output=True, text=True, check=True).stdout)
    assert (HEAVY | {"typer", "rich"}) & {name.split(".")[0] for name in loaded} == set()


RESULTS = (DiagnosisResult, DriveResult, PlanResult)


@pytest.mark.parametrize("kind", RESULTS)
def test_a_result_is_known_by_itself_and_prints_its_tables(kind):
    first, second = object.__new__(kind), object.__new__(kind)
    for result in (first, second):
        for field in fields(kind):
            object.__setattr__(result, field.name, {})  # equal in every field
    assert first != second
    assert len({first, second}) == 2
    assert not kind.__repr__.__qualname__.startswith(kind.__name__)
