"""No name that a pipeline of the project is told, or finds, is code to make or to the shell."""

import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st

from tests.odd_names import RAN, nothing_ran, odd_names
from tests.pipelines.bench import CHAIN, MAKE, REPOSITORY, Bench

pytestmark = pytest.mark.skipif(MAKE is None, reason="no make here: apt install make")
OUTPUTS = [
    ("paper", "PAPER_OUT"),
    ("track", "TRACK_OUT"),
    ("close-loop", "CLOSE_LOOP_OUT"),
    ("drive", "DRIVE_OUT"),
    ("challenge", "CHALLENGE_OUT"),
    ("real", "REAL_OUT"),
]


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """Return what makes a bench in a clone of the project, where code would leave its mark."""

    def made():
        bench = Bench(tmp_path_factory.mktemp("example"))
        (bench.folder / "clone").mkdir()
        for name in ("Makefile", "pipelines", "tsas_cli", "datasets", "requirements"):
            (bench.folder / "clone" / name).symlink_to(REPOSITORY / name)
        bench.settings.append("PYTHON=true")  # quicker than Python
        (bench.folder / "stamp").unlink()  # a command of make runs before those of a pipeline
        return bench, bench.folder / "clone"

    return made


def told(setting, name, *, environment):
    """Return the words and the environment that set a name, and the name that make reads."""
    if environment:
        return [], {setting: name}, name
    return [f"{setting}={name}"], {}, name.lstrip(" \t\n\v\f\r")  # which make takes away


def refused(done, bench):
    """Say whether make stopped; then it said so in one line, and asked the program for nothing."""
    event("refused" if done.returncode else "taken")
    if done.returncode:
        assert (done.returncode, done.stderr.count("\n"), bench.calls()) == (2, 1, [])
        assert " is no plain name" in done.stderr or " is empty" in done.stderr
    return bool(done.returncode)


@settings(max_examples=20)
@given(setting=st.sampled_from(["DATASET", "OUT"]), name=odd_names(), environment=st.booleans())
def test_a_pipeline_takes_a_name_or_refuses_it(clone, setting, name, environment):
    bench, home = clone()
    words, variables, name = told(setting, name, environment=environment)
    names = {"DATASET": "data", "OUT": "out"} | {setting: name}
    (home / (names["DATASET"] or "data")).mkdir()
    (home / names["DATASET"] / "dataset.toml").touch()
    other = [f"{key}={value}" for key, value in names.items() if key != setting]
    done = bench.run("pipeline", *words, *other, cwd=home, **variables)
    if not refused(done, bench):
        data, out = names["DATASET"], names["OUT"]
        ends = ["--rrd", "--force"]
        assert ["check", data, "--out", f"{out}/check", *ends] in bench.calls()
        folders = [f"{out}/{stage}" for stage in CHAIN[:-1]]
        page = ["--out", f"{out}/report.html", "--force"]
        assert bench.calls()[-1] == ["report", data, *folders, *page]
    assert nothing_ran(bench.folder)


@settings(max_examples=20)
@given(
    setting=st.sampled_from(["TSAS_DATA", "REAL", "REAL_OUT"]),
    name=odd_names(),
    environment=st.booleans(),
)
def test_public_recordings_lie_where_a_name_says(clone, setting, name, environment):
    bench, home = clone()
    words, variables, name = told(setting, name, environment=environment)
    names = {"TSAS_DATA": "data", "REAL": "a/b", "REAL_OUT": "out"} | {setting: name}
    other = [f"{key}={value}" for key, value in names.items() if key != setting]
    done = bench.run("real", *words, *other, cwd=home, **variables)
    if not refused(done, bench):
        asked = [names["REAL"]] if names["REAL"].strip() else []
        places = ["--data", names["TSAS_DATA"], "--out", names["REAL_OUT"]]
        assert bench.calls() == [["-m", "benchmarks.real", *asked, *places]]
    assert nothing_ran(bench.folder)


@pytest.mark.parametrize(("target", "setting"), OUTPUTS)
@settings(max_examples=10)
@given(name=odd_names(), environment=st.booleans())
@example(name=f"a$(shell >{RAN})", environment=False)
def test_an_output_has_a_name_or_is_refused(clone, target, setting, name, environment):
    bench, home = clone()
    words, variables, name = told(setting, name, environment=environment)
    done = bench.run(target, *words, "TSAS_DATA=data", cwd=home, **variables)
    if not refused(done, bench):
        for call in bench.calls():
            assert (call[call.index("--out") + 1] + "/").startswith(f"{name}/")
    assert nothing_ran(bench.folder)


def test_a_stage_is_told_a_quoted_name_as_it_is(clone):
    bench, home = clone()
    (home / "data").mkdir()
    (home / "data" / "dataset.toml").touch()
    words = ["pipeline", "DATASET=data", "OUT=out", f"STAGE=--runs 'a;>{RAN};' --force"]
    assert bench.make(*words, cwd=home) == CHAIN
    assert all(call[-3:] == ["--runs", f"a;>{RAN};", "--force"] for call in bench.calls()[:-1])
    assert nothing_ran(bench.folder)
