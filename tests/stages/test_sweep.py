"""`tsas.sweep`: tasks are calls of the stages, done once, and gathered in tables."""

import json
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest

import tsas_cli as tsas
from tests.counted import Counted
from tests.rigs import dataset_of, recorded
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.support.files import sha256_of
from tsas_cli.sweeping.folder import sweep_folder
from tsas_cli.sweeping.outcome import ONE_THREAD, run_task
from tsas_studies.challenge.rig.tendon import Rig

RIG = Rig(friction_coefficient=0.16, cells=60)


@pytest.fixture(scope="module", autouse=True)
def _done_in_this_process():
    """Spare each test the start of a worker; tests/sweeping and tests/commands have real ones."""

    def here(work, texts, workers):
        for number, text in enumerate(texts):
            yield number, json.loads(run_task(work, text))

    with pytest.MonkeyPatch.context() as patch:
        for name, value in ONE_THREAD.items():
            patch.setenv(name, value)  # as a task sets it
        patch.setattr("tsas_cli.stages.sweep.in_processes", here)
        yield


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """Three datasets of one run each; of one, the recording is not what its manifest says."""
    folder = tmp_path_factory.mktemp("sweep")
    for name in ("a", "b"):
        dataset_of(RIG, folder / "rigs" / name, x=recorded(RIG))
    shutil.copytree(folder / "rigs/a", folder / "rigs/broken")
    (folder / "rigs/broken/runs/x.parquet").write_bytes(b"no Parquet")
    return folder


@pytest.fixture(scope="module")
def swept(base):
    """Return what came of simulations over friction, bend and preload, and the steps told of."""
    vary = {"friction_coefficient": [0.1, 0.2], "total_bend_rad": [2.0, 3.0]}
    vary["preload_N"] = [20.0, 30.0]
    plan = {"stage": "simulate", "datasets": str(base / "rigs/a"), "vary": vary}
    steps = Counted()
    return tsas.sweep(plan, out=base / "swept", workers=1, step=steps), steps


def written(folder):
    return {
        str(p.relative_to(folder)): sha256_of(p) for p in sorted(folder.rglob("*")) if p.is_file()
    }


def begun(out):
    return (out / "journal.jsonl").read_text(encoding="utf-8").splitlines()


def test_each_task_is_the_call_that_anyone_could_write(base, swept):
    result, _ = swept
    data = tsas.read(base / "rigs/a").under(total_bend_rad=3.0, preload_N=20.0)
    model = tsas.simulate(data).model
    friction = Estimate("friction_coefficient", 0.2, "1", "given")
    told = [e for e in model.estimates if e.name != friction.name]
    run_task = tsas.simulate(data, model=Model((friction, *told)))
    point = {"friction_coefficient": 0.2, "total_bend_rad": 3.0, "preload_N": 20.0}
    (row,) = (row for row in result.summary["tasks"] if row.items() >= point.items())
    channels = run_task.summary["runs"]["x"]["channels"]
    assert row["rmse_f_in_N"] == channels["f_in_N"]["rmse"]
    assert row["highest_f_in_N"] == run_task["x"].columns["f_in_N"].max()
    assert row["lowest_f_out_N"] == run_task["x"].columns["f_out_N"].min()
    task = base / "swept" / "tasks" / row["task"]
    simulation = json.loads((task / "simulation.json").read_text(encoding="utf-8"))
    assert simulation["conditions"] == {"total_bend_rad": 3.0, "preload_N": 20.0}
    assert simulation["runs"] == json.loads(json.dumps(run_task.summary["runs"]))
    assert (task / simulation["dataset"]["folder"]).resolve() == (base / "rigs/a").resolve()


def test_physics_goes_the_way_that_it_must(swept):
    frame = swept[0].frame()
    mean = frame.groupby("friction_coefficient")["highest_f_in_N"].mean()
    assert mean[0.2] > 1.2 * mean[0.1]  # more friction, more tension at the drive
    lowest = frame.groupby("preload_N")["lowest_f_out_N"].mean()
    assert lowest[30.0] - lowest[20.0] == pytest.approx(10.0, abs=1.0)


def test_the_table_has_a_row_for_each_task(base, swept):
    result, steps = swept
    assert steps.all_of(least=8)
    table = pq.read_table(base / "swept" / "sweep.parquet")
    assert table.num_rows == 8
    varied = ["friction_coefficient", "total_bend_rad", "preload_N"]
    assert table.column_names[:5] == ["task", "dataset", *varied]
    assert set(table["state"].to_pylist()) == {"done"}
    assert table["highest_f_in_N"].to_pylist() == list(result.frame()["highest_f_in_N"])
    tasks = {path.name for path in (base / "swept" / "tasks").iterdir()}
    assert tasks == set(table["task"].to_pylist())


def test_what_is_done_is_not_done_again_and_all_is_the_same(base, swept):
    out = base / "swept"
    before, plan = written(out), json.loads((out / "sweep.json").read_text())["plan"]
    done = begun(out)
    again = tsas.sweep(plan, out=out, workers=1)
    assert begun(out) == done
    assert again.before == 8
    assert written(out) == before
    assert again.summary["tasks"] == swept[0].summary["tasks"]
    victim = out / "tasks" / swept[0].summary["tasks"][3]["task"]
    victim.rename(victim.with_name(f".{victim.name}.killed"))  # as if killed half-way
    more = plan | {"vary": plan["vary"] | {"preload_N": [20.0, 30.0, 40.0]}}
    steps = Counted()
    assert tsas.sweep(more, out=out, workers=1, step=steps).before == 7
    assert len(begun(out)) == 8 + 5
    assert steps.all_of(least=5)
    assert not list((out / "tasks").glob(".*"))
    tsas.sweep(plan, out=out, workers=1)
    now = written(out)
    assert {name for name in before if now[name] != before[name]} == {"journal.jsonl"}


@pytest.mark.parametrize("name", ["sweep.json", "sweep.parquet"])
def test_a_table_of_a_sweep_that_was_edited_is_told(base, tmp_path, name):
    out = tmp_path / "out"
    plan = {"stage": "check", "datasets": str(base / "rigs/a")}
    tsas.sweep(plan, out=out, workers=1)
    odd = [one for one in tsas.verify(out).files if one.state != "fits"]
    assert [(Path(one.file).name, one.state) for one in odd] == [("journal.jsonl", "cannot tell")]
    with (out / name).open("ab") as file:
        file.write(b" ")
    assert [Path(one.file).name for one in tsas.verify(out).wrong] == [name]
    tsas.sweep(plan, out=out, workers=1)
    assert tsas.verify(out).wrong == []


def test_a_task_that_fails_is_named_with_its_input_and_the_rest_completes(base):
    out = base / "all"
    plan = {"stage": "simulate", "datasets": str(base / "rigs/*")}
    result = tsas.sweep(plan, out=out, workers=1)
    assert result.summary["counts"] == {"done": 2, "failed": 1}
    assert result.defects == 0
    ((key, error),) = result.failed.items()
    assert error.startswith(f"{base}/rigs/broken/runs/x.parquet: the checksum differs")
    assert not (out / "tasks" / key).exists()
    table = pq.read_table(out / "sweep.parquet").to_pylist()
    assert [row["state"] for row in table] == ["done", "done", "failed"]
    assert [bool(row["error"]) for row in table] == [False, False, True]
    shutil.copy(base / "rigs/a/runs/x.parquet", base / "rigs/broken/runs/x.parquet")
    mended = tsas.sweep(plan, out=out, workers=1)  # the failed one is tried again, it alone
    assert (mended.before, mended.failed) == (2, {})
    first = written(out / "tasks")
    tsas.sweep(plan, out=out, workers=1, force=True)  # all of them once more
    assert len(begun(out)) == 3 + 1 + 3
    assert written(out / "tasks") == first


def test_parameters_keep_interval_unit_and_bound_flag(base):
    plan = {"stage": "calibrate", "datasets": str(base / "rigs/a")}
    result = tsas.sweep(plan, out=base / "calibrated", workers=1)
    direct = tsas.calibrate(base / "rigs/a")
    rows = pq.read_table(base / "calibrated" / "parameters.parquet").to_pylist()
    assert [(r["name"], r["of_run"], r["value"]) for r in rows] == [
        (e.name, e.run, e.value) for e in direct.model.estimates
    ]
    friction = next(row for row in rows if row["name"] == "friction_coefficient")
    assert friction["interval_low"] < RIG.friction_coefficient < friction["interval_high"]
    assert (friction["unit"], friction["at_bound"]) == ("1", False)
    (row,) = result.summary["tasks"]
    assert row["fitted_friction_coefficient"] == friction["value"]
    assert row["fitted_friction_coefficient_low"] == friction["interval_low"]
    assert row["converged"] is True


def test_the_closed_loop_takes_model_plant_and_settings(tmp_path):
    plan = {
        "stage": "track",
        "options": {"controllers": "pid", "settings.reference.duration_s": 2.0},
        "vary": {"plant.friction_coefficient": [0.125, 0.3]},
    }
    rows = tsas.sweep(plan, out=tmp_path / "out", workers=1).summary["tasks"]
    same, other = (row["rmse_N"] for row in rows)
    assert other > 1.5 * same  # the controller does not know the plant's friction
    settings = {"reference": {"duration_s": 2.0}}
    model = Model((Estimate("friction_coefficient", 0.3, "1", "given"),))
    run_task = tsas.track(controllers="pid", plant=model, settings=settings)
    assert run_task.summary["results"][0]["scores"]["rmse_N"]["mean"] == other
    assert run_task.summary["settings"]["file"] == "in memory"


def test_two_sweeps_do_not_write_into_one_folder(base, tmp_path):
    plan, out = {"stage": "check", "datasets": str(base / "rigs/a")}, tmp_path / "out"
    said = "another sweep is writing here"
    with sweep_folder(out, []), pytest.raises(tsas.InputError, match=said):
        tsas.sweep(plan, out=out, workers=1)


def test_workers_and_a_cluster_exclude_each_other(tmp_path):
    with pytest.raises(tsas.InputError, match="leave out one of the two"):
        tsas.sweep({"stage": "track"}, out=tmp_path / "o", workers=2, cluster="tcp://x:1")
    with pytest.raises(tsas.InputError, match="workers is 0"):
        tsas.sweep({"stage": "track"}, out=tmp_path / "o", workers=0)
    assert not Path(tmp_path / "o").exists()


def test_an_earlier_table_stays_until_the_next_is_whole(base, tmp_path):
    out, plan = tmp_path / "out", {"stage": "simulate", "datasets": str(base / "rigs/a")}
    tsas.sweep(plan, out=out, workers=1)
    before = written(out)
    with pytest.raises(tsas.InputError, match=r"scheduler|cluster"):
        tsas.sweep(plan, out=out, cluster="nonsense://x", force=True)
    assert written(out) == before
