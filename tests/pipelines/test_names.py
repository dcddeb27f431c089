"""No name that a pipeline of the project is told, or finds, is code to make or to the shell."""

import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st

from tests.odd_names import RAN, nothing_ran, odd_names
from tests.pipelines.bench import CHAIN, MAKE, REPOSITORY, Bench

pytestmark = pytest.mark.skipif(MAKE is None, reason="no make here: apt install make")
TARGETS = ("paper", "track", "close-loop", "drive", "challenge")
OUTPUTS = [(target, f"{target.upper().replace('-', '_')}_OUT") for target in TARGETS]


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


def calls_of(made, target, names, setting, name, *, environment):
    """Run a target under names, one of them drawn; return its calls and the names as make reads.

    Where make refuses, it does so in one line and asks the program for nothing: None.
    """
    bench, home = made()
    words, variables = ([], {setting: name}) if environment else ([f"{setting}={name}"], {})
    words += [f"{key}={value}" for key, value in names.items() if key != setting]
    if not environment:
        name = name.lstrip(" \t\n\v\f\r")  # which make takes away
    names = names | {setting: name}
    data = home / (names.get("DATASET") or "data")
    data.mkdir()
    (data / "dataset.toml").touch()
    done = bench.run(target, *words, cwd=home, **variables)
    assert nothing_ran(bench.folder)
    event("refused" if done.returncode else "taken")
    if done.returncode:
        assert (done.returncode, done.stderr.count("\n"), bench.calls()) == (2, 1, [])
        assert " is no plain name" in done.stderr or " is empty" in done.stderr
    return None if done.returncode else bench.calls(), names


@settings(max_examples=20)
@given(setting=st.sampled_from(["DATASET", "OUT"]), name=odd_names(), environment=st.booleans())
def test_a_pipeline_takes_a_name_or_refuses_it(clone, setting, name, environment):
    names = {"DATASET": "data", "OUT": "out"}
    calls, names = calls_of(clone, "pipeline", names, setting, name, environment=environment)
    if calls is not None:
        data, out = names["DATASET"], names["OUT"]
        assert ["check", data, "--out", f"{out}/check", "--rrd", "--force"] in calls
        folders = [f"{out}/{stage}" for stage in CHAIN[:-1]]
        assert calls[-1] == ["report", data, *folders, "--out", f"{out}/report.html", "--force"]


@settings(max_examples=20)
@given(
    setting=st.sampled_from(["TSAS_DATA", "REAL", "REAL_OUT"]),
    name=odd_names(),
    environment=st.booleans(),
)
def test_public_recordings_lie_where_a_name_says(clone, setting, name, environment):
    names = {"TSAS_DATA": "data", "REAL": "a/b", "REAL_OUT": "out"}
    calls, names = calls_of(clone, "real", names, setting, name, environment=environment)
    if calls is not None:
        asked = [names["REAL"]] if names["REAL"].strip() else []
        places = ["--data", names["TSAS_DATA"], "--out", names["REAL_OUT"]]
        assert calls == [["-m", "benchmarks.real", *asked, *places]]


@pytest.mark.parametrize(("target", "setting"), OUTPUTS)
@settings(max_examples=5)
@given(name=odd_names(), environment=st.booleans())
@example(name=f"a$(shell >{RAN})", environment=False)
def test_an_output_has_a_name_or_is_refused(clone, target, setting, name, environment):
    calls, names = calls_of(clone, target, {}, setting, name, environment=environment)
    for call in calls or ():
        assert (call[call.index("--out") + 1] + "/").startswith(f"{names[setting]}/")


def test_a_stage_is_told_a_quoted_name_as_it_is(clone):
    bench, home = clone()
    (home / "data").mkdir()
    (home / "data" / "dataset.toml").touch()
    words = ["pipeline", "DATASET=data", "OUT=out", f"STAGE=--runs 'a;>{RAN};' --force"]
    assert bench.make(*words, cwd=home) == CHAIN
    assert all(call[-3:] == ["--runs", f"a;>{RAN};", "--force"] for call in bench.calls()[:-1])
    assert nothing_ran(bench.folder)
