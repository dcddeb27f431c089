"""The tasks of a plan: what each is told, and names that change when that does."""

import json
import shutil

import pytest

from tests.sweeping.test_plan import SIMULATE
from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.stages.sweep import options_of
from tsas_cli.support.errors import InputError
from tsas_cli.sweeping import tasks as module
from tsas_cli.sweeping.plan import read_plan
from tsas_cli.sweeping.tasks import tasks_of
from tsas_cli.sweeping.values import with_settings


@pytest.fixture
def rigs(tmp_path, dataset):
    for name in ("a", "b"):
        shutil.copytree(dataset, tmp_path / "rigs" / name)
    (tmp_path / "rigs" / "notes.txt").touch()
    (tmp_path / "rigs" / "empty").mkdir()
    return tmp_path


def tasks(base, **more):
    plan, _ = read_plan({k: v for k, v in (SIMULATE | more).items() if v is not None})
    return tasks_of(plan, base, options_of(plan.stage))


def keys(base, **more):
    return [task.key for task in tasks(base, **more)]


def test_a_pattern_takes_the_datasets_in_order_and_passes_over_others(rigs):
    assert [task.source.name for task in tasks(rigs)] == ["rigs/a", "rigs/b"]
    assert [key.rpartition("-")[0] for key in keys(rigs)] == ["rigs-a", "rigs-b"]
    assert len(tasks(rigs, datasets=["rigs/*", "rigs/a"])) == 2  # patterns may overlap
    assert len(tasks(rigs, datasets=str(rigs / "rigs/*"))) == 2


def test_every_run_may_be_a_task(rigs):
    found = tasks(rigs, each_run=True)
    assert [task.source.run for task in found] == ["a", "a"]
    assert [task.inputs["options"] for task in found] == [{"runs": ["a"]}] * 2
    (rigs / "rigs/b/dataset.toml").write_text("broken")
    assert [task.source.run for task in tasks(rigs, each_run=True)] == ["a", None]


def test_a_name_says_what_is_varied_and_changes_with_all_that_matters(rigs, monkeypatch):
    varied = {"vary": {"preload_N": [20, 25.5]}}
    first = keys(rigs, datasets="rigs/a", **varied)
    assert [key.rpartition("-")[0] for key in first] == ["preload_N=20", "preload_N=25.5"]
    assert keys(rigs, datasets="rigs/a", **varied) == first
    assert not set(keys(rigs, datasets="rigs/a", options={"nodes": 20}, **varied)) & set(first)
    assert not set(keys(rigs, datasets="rigs/b", **varied)) & set(first)
    monkeypatch.setattr(module, "versions", lambda: {"tsas": "9"})
    assert not set(keys(rigs, datasets="rigs/a", **varied)) & set(first)
    monkeypatch.undo()
    manifest = rigs / "rigs/a/dataset.toml"
    manifest.write_text(manifest.read_text() + "\n# ingested again\n")
    assert not set(keys(rigs, datasets="rigs/a", **varied)) & set(first)


def test_a_name_does_not_change_with_the_place(rigs, tmp_path):
    first = keys(rigs)
    shutil.copytree(rigs / "rigs", tmp_path / "moved" / "rigs")
    assert keys(tmp_path / "moved") == first


def test_a_model_counts_by_its_content(rigs):
    model = rigs / "m.toml"
    model.write_text("format = 1\n")
    first = keys(rigs, options={"model": "m.toml"})
    model.write_text("format = 1 # other\n")
    assert not set(keys(rigs, options={"model": "m.toml"})) & set(first)
    (rigs / "calibrated").mkdir()
    model.rename(rigs / "calibrated" / "model.toml")
    task = tasks(rigs, options={"model": "calibrated"})[0]
    assert task.places["model"] == str(rigs / "calibrated" / "model.toml")


def test_values_are_sorted_by_what_they_are_of(rigs):
    values = {"nodes": 30, "total_bend_rad": 2, "backlash.play_mm": 0.1, "preload_N": 20}
    inputs = tasks(rigs, options=values)[0].inputs
    assert inputs["options"] == {"nodes": 30}
    assert inputs["conditions"] == {"total_bend_rad": 2.0, "preload_N": 20.0}
    # A calibrated model holds the preload of each run, over which what is told has to win.
    assert inputs["model"] == {"backlash.play_mm": 0.1, "preload_N": 20.0}
    values = {"friction_coefficient": 0.1, "plant.friction_coefficient": 0.2}
    values |= {"settings.reference.mean_N": 40.0, "controllers": "pid"}
    inputs = tasks(rigs, stage="track", datasets=None, options=values)[0].inputs
    assert inputs["model"] == {"friction_coefficient": 0.1}
    assert inputs["plant"] == {"friction_coefficient": 0.2}
    assert inputs["settings"] == {"reference.mean_N": 40.0}
    assert inputs["options"] == {"controllers": "pid"}


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"options": {"node": 30}}, "unknown name node; did you mean nodes?"),
        ({"options": {"frictoin": 0.1}}, "frictoin; did you mean friction_coefficient?"),
        ({"options": {"out": "x"}}, "unknown name out"),
        ({"options": {"nodes": 2.5}}, "nodes is 2.5; expected .* valid integer"),
        ({"options": {"dynamics": "fast"}}, "dynamics is 'fast'; expected .* 'static'"),
        ({"options": {"runs": "a"}}, "runs is 'a'; expected .* valid list"),
        ({"vary": {"friction_coefficient": [0.1, -1]}}, "friction_coefficient is -1; expected 0"),
        ({"vary": {"total_bend_rad": ["much"]}}, "total_bend_rad is 'much'; expected a number"),
        ({"vary": {"preload_N": [True]}}, "preload_N is True; expected a number"),
        ({"vary": {"preload_N": [10**400]}}, "preload_N is an integer of 1330 bits; .* at most 64"),
        ({"options": {"nodes": -(16**6000)}}, "nodes is an integer of 24002 bits; .* at most 64"),
        ({"vary": {"total_bend_rad": [2.0, float("nan")]}}, "total_bend_rad is nan; .* finite"),
        ({"vary": {"friction_coefficient": [float("inf")]}}, "friction_coefficient is inf; .* fin"),
        ({"vary": {"total_bend_rad": [-1]}}, "total_bend_rad: expected 0, or 1e-09 .* rad, got -1"),
        ({"vary": {"friction_coefficient": [99.0]}}, r"is 99; expected \S+ to [\d.]+$"),
        ({"options": {"sheath_length_mm": 0}}, "the plan: sheath_length_mm: expected .* mm, got 0"),
        ({"options": {"model": "m.toml"}}, "m.toml: does not exist; expected the file of model"),
        ({"options": {"model": 3}}, "model is 3; expected a file's path"),
        ({"vary": {"nodes": [10, 20, 10]}}, "duplicate task .*; expected distinct points"),
        ({"datasets": "rigs/c"}, r"rigs/c: does not exist; expected a dataset folder$"),
        ({"datasets": "rigs"}, r"its subfolders are datasets: use 'rigs/\*'"),
        ({"datasets": "rigs/e*"}, r"rigs/e\*: no dataset matches; .*; 1 other files and folders"),
        ({"stage": "check", "options": {"preload_N": 2}}, "unknown name preload_N"),
    ],
)
def test_what_is_wrong_is_reported_before_anything_is_done(rigs, more, message):
    with pytest.raises(InputError, match=message):
        tasks(rigs, **more)


def test_names_of_the_closed_loop_are_not_those_of_recordings(rigs):
    assert {"total_bend_rad", "sheath_length_mm"} <= set(CONDITIONS)
    conditions = ("total_bend_rad", "sheath_length_mm")
    for name, message in (
        *((name, f"unknown name {name}; did you mean settings.rig") for name in conditions),
        ("zzz", "known are model, .*, and the parameters of a model: see `tsas"),
        ("settings.reference.mean", "settings: unknown key reference.mean .*mean_N"),
    ):
        with pytest.raises(InputError, match=message):
            tasks(rigs, stage="track", datasets=None, options={name: 2})


def test_settings_are_told_over_those_of_a_file(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("[reference]\nmean_N = 40.0\namplitude_N = 5.0\n")
    values = with_settings(path, {"reference.mean_N": 30.0, "rig.total_bend_rad": 2.0})
    assert values["reference"] == {"mean_N": 30.0, "amplitude_N": 5.0}
    assert values["rig"] == {"total_bend_rad": 2.0}
    with pytest.raises(InputError, match=r"mean_N of settings\.reference\.mean_N\.x is no table"):
        with_settings(path, {"reference.mean_N.x": 1.0})


def test_a_task_travels_as_plain_text(rigs):
    task = tasks(rigs)[0]
    values = json.loads(task.text(rigs / "out", force=True))
    assert values["key"] == task.key
    assert values["force"] is True
    assert values["places"] == {"dataset": str(rigs / "rigs/a"), "out": str(rigs / "out")}
