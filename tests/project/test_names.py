"""No name in a project is code: not to make, not to the shell, not in what `tsas init` writes."""

import shutil

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from tests.odd_names import RAN, nothing_ran, odd_names
from tests.pipelines.bench import CHAIN, MAKE, Bench, project_in
from tests.project.recorded import recorded
from tests.recordings.guess.rig_files import CHANNELS
from tsas_cli.project.start import start
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.support.errors import InputError

pytestmark = pytest.mark.skipif(MAKE is None, reason="no make here: apt install make")
SETTINGS = {"RAW": "raw", "MAP": "bench.toml", "DATASET": "dataset", "OUT": "result"}
FROM_THE_ISSUE = {f";id>{RAN};.csv", f"';id>{RAN};'.csv", "a|b.csv", "a\tb.csv", "a\nb.csv"}


def ingest(names):
    return ["ingest", names["RAW"], "--map", names["MAP"], "--out", names["DATASET"], "--force"]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("rig") / "a.csv").read_bytes()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return what makes a new folder: one fixture serves every example."""
    return lambda: tmp_path_factory.mktemp("example")


@settings(max_examples=6)
@given(name=odd_names(), sources=st.sets(odd_names(end=".csv"), min_size=1, max_size=8))
@example(name="project", sources=FROM_THE_ISSUE)
def test_a_new_project_is_made_and_run_under_any_name(folder, recording, name, sources):
    home = folder()
    bench = Bench(home)
    (home / "in").mkdir()
    for source in sources:
        (home / "in" / source).write_bytes(recording)
    project = home / name
    if "\udcff" in name:  # which no file of text can hold
        with pytest.raises(InputError, match="its name is not UTF-8"):
            start(project, sorted((home / "in").iterdir()))
        return
    start(project, sorted((home / "in").iterdir()))
    assert {path.name for path in (project / "raw").iterdir()} == {*sources, "README.md"}
    assert read_map(project / "bench.toml").columns["f_in_N"].source == "Force in [N]"
    assert bench.make(cwd=project) == ["ingest", *CHAIN]
    assert bench.calls()[0] == ingest(SETTINGS)
    assert bench.make(cwd=project) == []
    assert nothing_ran(home)


@given(name=odd_names())
def test_the_map_of_an_empty_project_is_a_map_under_any_name(folder, name):
    assume(name != "?" and "\udcff" not in name)  # which asks; which is no text, and refused
    home = folder()
    start(home / name, [])
    path = home / name / "bench.toml"
    text, asked = path.read_text().replace('unit = "?"', ""), 'source = "?"'
    for number in range(1, 1 + text.count(asked)):
        text = text.replace(asked, f"source = {number}", 1)
    path.write_text(text)
    assert set(read_map(path).columns) == set(CHANNELS)
    title, below, *_ = (home / name / "README.md").read_text().splitlines()
    assert (title[:2], below) == ("# ", "")


@settings(max_examples=3)
@given(
    first=st.sets(odd_names(), min_size=1, max_size=8),
    later=st.sets(odd_names(), min_size=1, max_size=8),
)
@example(first={"a.csv"}, later=FROM_THE_ISSUE)
def test_a_file_that_comes_or_goes_is_noticed_under_any_name(folder, first, later):
    home = folder()
    bench, project = Bench(home), project_in(home)
    for name in first:
        (project / "raw" / name).touch()
    assert bench.make(cwd=project) == ["ingest", *CHAIN]
    bench.age("project")
    for name in later:
        (project / "raw" / name).touch()
    noticed = {name for name in later if not name.startswith((".", "README"))} | (later - first)
    if noticed:
        assert bench.run("-n", cwd=project).stdout.count("\n") == len(CHAIN) + 1
    assert bench.make(cwd=project) == (["ingest", *CHAIN] if noticed else [])
    bench.age("project")
    (project / "raw" / min(later)).unlink()
    assert bench.make(cwd=project) == ["ingest", *CHAIN]
    assert bench.make(cwd=project) == []
    assert nothing_ran(home)


@pytest.mark.parametrize(
    ("setting", "name", "message"),
    [
        ("RAW", "my rig: run #2; 100 % [new]?", None),
        ("RAW", f'(";>{RAN};" |>{RAN}', None),
        ("MAP", "R&D (2).toml", None),
        ("MAP", f"a=b &>{RAN}", None),
        ("DATASET", f"R&D (2)  <`>{RAN}`>", None),
        ("DATASET", "x += #1]", None),
        ("OUT", 'my "result", {new}!', None),
        ("OUT", "# a=b", None),
        ("RAW", f"$(shell >{RAN})", "RAW is no plain name"),
        ("RAW", "o'brien", "RAW is no plain name"),
        ("OUT", "-x", "OUT is no plain name"),
        ("OUT", "~/x", "OUT is no plain name"),
        ("DATASET", "a:b", "DATASET is no plain name"),
        ("MAP", "a\nb", "MAP is no plain name"),
        ("MAP", "a\t", "MAP is no plain name"),
        ("OUT", "", "OUT is empty: expected OUT=NAME"),
        *(("OUT", f"a{sign}b", "OUT is no plain name") for sign in "$'%:;|*?[\\"),
    ],
)
def test_a_setting_that_is_odd_and_no_code_is_taken_and_another_is_named(
    tmp_path, setting, name, message
):
    bench, project = Bench(tmp_path), project_in(tmp_path)
    if message is None:
        names = SETTINGS | {setting: name}
        (project / SETTINGS[setting]).is_file() and (project / name).touch()
        assert bench.make(f"{setting}={name}", cwd=project) == ["ingest", *CHAIN]
        assert bench.calls()[0] == ingest(names)
        assert bench.calls()[-1][-2:] == [f"{names['OUT']}/report.html", "--force"]
        assert bench.make(f"{setting}={name}", cwd=project) == []
    else:
        done = bench.run(f"{setting}={name}", cwd=project)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.count("\n") == 1
        assert message in done.stderr
    assert nothing_ran(tmp_path)


def test_a_makefile_may_build_a_name_of_others(tmp_path):
    bench, project = Bench(tmp_path), project_in(tmp_path)
    path = project / "Makefile"
    path.write_text(path.read_text().replace("OUT = result", "OUT = $(DATASET)-$(WHAT)"))
    bench.make("WHAT=page", cwd=project)
    assert (project / "dataset-page" / "report.html").is_file()
    done = bench.run("WHAT=it's", cwd=project)
    assert "OUT is no plain name" in done.stderr


@settings(max_examples=5)
@given(name=odd_names())
def test_a_quoted_run_among_the_options_reaches_the_program_as_it_is(folder, name):
    name = name.replace("\n", "")  # which ends a command for make
    home = folder()
    bench, project = Bench(home), project_in(home)
    quoted = "'{}'".format(name.replace("'", "'\\''").replace("$", "$$"))
    bench.make(f"DIAGNOSE=--runs {quoted}", cwd=project)
    (call,) = (call for call in bench.calls() if call[0] == "diagnose")
    assert call[call.index("--runs") + 1] == name
    assert nothing_ran(home)


def test_rules_that_make_brings_along_are_not_used(tmp_path):
    bench, project = Bench(tmp_path), project_in(tmp_path)
    (project / f"`>{RAN}`,v").touch()  # make would have it checked out of RCS
    done = bench.run(f"MAP=`>{RAN}`", cwd=project)
    assert "No rule to make target" in done.stderr
    assert nothing_ran(tmp_path)


def test_what_init_says_to_do_next_can_be_pasted(tsas, tmp_path):
    done = tsas("init", "$(touch ran); it's new", cwd=tmp_path)
    *_, last = done.stdout.splitlines()
    assert last.endswith("""then `make -C '$(touch ran); it'"'"'s new'`""")
    shutil.rmtree(tmp_path / "$(touch ran); it's new")
    done = tsas("init", "a\nb", cwd=tmp_path)
    assert done.stdout.splitlines()[-1] == (
        r"Next: answer the questions in a\nb/bench.toml, then `make -C 'a\nb'`"
    )
