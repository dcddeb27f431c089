"""Which stages run again: the pipelines with a program that only notes what it is asked for."""

import shutil
import subprocess

import pytest

from tests.pipelines.bench import CHAIN, MAKE, REPOSITORY, Bench, project_in

STEPS = REPOSITORY / "tsas_cli" / "project" / "make"
pytestmark = pytest.mark.skipif(MAKE is None, reason="no make here: apt install make")


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)


@pytest.fixture
def chain(bench):
    (bench.folder / "my data").mkdir()
    (bench.folder / "my data" / "dataset.toml").touch()
    words = [word for name in ("names.mk", "chain.mk") for word in ("-f", str(STEPS / name))]
    words += ["DATASET=my data", "OUT=my result", "STAGE=--force"]

    def call(*more, code=0):
        return bench.make(*words, *more, cwd=bench.folder, code=code)

    assert sorted(call()) == sorted(CHAIN)
    return call


@pytest.mark.parametrize(
    ("touched", "again"),
    [
        (None, []),
        ("my data/dataset.toml", CHAIN),
        ("stamp", CHAIN),
        ("my result/check/check.json", ["report"]),
        ("my result/calibrate/model.toml", ["simulate", "diagnose", "report"]),
        ("my result/simulate/simulation.json", ["report"]),
    ],
)
def test_a_stage_runs_again_when_what_it_reads_has_changed(chain, bench, touched, again):
    if touched:
        bench.age("my data", "my result")
        bench.touch(touched)
    assert chain("-n") == []
    assert chain("-q", code=1 if again else 0) == []
    assert chain() == again


def test_a_stage_that_fails_is_not_taken_for_done(chain, bench):
    bench.age("my data", "my result")
    bench.touch("my data/dataset.toml")
    bench.fail.write_text("simulate")
    assert chain(code=2)[-1] == "simulate"
    assert chain(code=2) == ["simulate"]
    bench.fail.write_text("")
    assert chain() == ["simulate", "diagnose", "report"]
    assert chain() == []


def test_another_dataset_or_option_is_seen(chain, bench):
    (bench.folder / "other").mkdir()
    bench.touch("other/dataset.toml")
    bench.age("my data", "my result", "other")
    assert chain("DIAGNOSE=--runs a") == ["diagnose", "report"]
    assert chain("DIAGNOSE=--runs a") == []
    assert chain("DATASET=other") == CHAIN
    assert chain("DATASET=other") == []
    assert chain() == CHAIN


def test_a_folder_that_is_gone_is_made_again(chain, bench):
    shutil.rmtree(bench.folder / "my result" / "simulate")
    assert chain() == ["simulate", "report"]


@pytest.mark.parametrize("name", ["b.csv", "b [1].csv", "100 %: #2 $x.csv", "sub/b.csv"])
def test_a_project_looks_at_every_raw_file_and_at_those_that_go(bench, name):
    project = project_in(bench.folder)
    raw = project / "raw"
    (raw / name).parent.mkdir(exist_ok=True)
    (raw / "a.csv").touch()
    (raw / name).touch()

    def made():
        again = bench.make(cwd=project)
        bench.age("project")
        return again

    assert made() == ["ingest", *CHAIN]
    assert made() == []
    bench.touch(raw / name)
    assert made() == ["ingest", *CHAIN]
    bench.touch("project/bench.toml")
    assert made() == ["ingest", *CHAIN]
    (project / "other.toml").touch()
    bench.age("project")
    assert bench.make("MAP=other.toml", cwd=project) == ["ingest", *CHAIN]
    assert made() == ["ingest", *CHAIN]
    (raw / "README.md").touch()
    bench.age("project")
    (raw / name).unlink()
    assert made() == ["ingest", *CHAIN]
    assert made() == []


def test_a_project_follows_links_and_overlooks_what_is_no_recording(bench):
    raw = project_in(bench.folder) / "raw"
    (raw / "deep").mkdir()
    for name in ("README.md", ".DS_Store"):
        (raw / "deep" / name).touch()
    (bench.folder / "elsewhere").mkdir()
    (bench.folder / "elsewhere" / "a.csv").touch()
    (raw / "a.csv").symlink_to(bench.folder / "elsewhere" / "a.csv")
    bench.age("elsewhere")
    assert bench.make(cwd=raw.parent) == ["ingest", *CHAIN]
    bench.age("project")
    for name in ("README.md", ".DS_Store"):
        bench.touch(raw / "deep" / name)
    assert bench.make(cwd=raw.parent) == []
    bench.touch("elsewhere/a.csv")
    assert bench.make(cwd=raw.parent) == ["ingest", *CHAIN]


def test_the_settings_of_a_project_reach_its_stages(bench):
    words = ("-n", "CALIBRATE=--dynamics lugre", "STAGE=--force --quiet")
    done = bench.run(*words, cwd=project_in(bench.folder))
    stages = dict(line.split(maxsplit=2)[1:] for line in done.stdout.splitlines())
    assert stages["calibrate"].endswith("--dynamics lugre --force --quiet")
    assert stages["diagnose"].endswith("--force --quiet")


@pytest.mark.parametrize(
    ("target", "where", "stages"),
    [
        ("track", "TRACK_OUT", ["track", "report"]),
        ("close-loop", "CLOSE_LOOP_OUT", ["close-loop", "report"]),
        ("drive", "DRIVE_OUT", ["check", "identify-harmonic-drive", "report"]),
        ("paper", "PAPER_OUT", ["reproduce"]),
    ],
)
def test_a_pipeline_of_the_project_runs_once_until_the_program_changes(
    bench, target, where, stages
):
    out = f"{where}={bench.folder / 'out'}"
    assert bench.make(target, out) == stages
    assert bench.make(target, out) == []
    assert bench.make("-q", target, out) == []
    bench.age("out")
    bench.touch("stamp")
    assert bench.make("-n", target, out) == []
    assert bench.make(target, out) == stages


def test_own_data_of_the_project_run_once(bench):
    (bench.folder / "d").mkdir()
    bench.touch("d/dataset.toml")
    words = ["pipeline", f"DATASET={bench.folder / 'd'}", f"OUT={bench.folder / 'out'}"]
    assert bench.make(*words) == CHAIN
    assert bench.make(*words) == []
    assert bench.make("-q", *words) == []
    assert bench.make("pipeline", code=2) == []
    assert bench.make("pipeline", f"DATASET={bench.folder}", "OUT=x", code=2) == []


def test_no_rule_is_there_twice():
    call = [MAKE, "-n", "setup"]
    done = subprocess.run(call, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
