"""Results on standard output, talk on standard error: the same rule for every command."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
from contextlib import nullcontext

import pytest

import tsas_cli
import tsas_cli.app
from tests.rigs import dataset_of, recorded
from tests.terminal import read_from
from tests.test_app import CALLS
from tsas_cli.commands.common import progress
from tsas_cli.records.result import Result
from tsas_cli.support.stopping import EXIT_CODE
from tsas_studies.challenge.rig.tendon import Rig

SUMMARY = {"format": 1, "stage": "any", "value": 1.5}
VERBS = {  # of commands whose function has another name
    "effects": "tsas_cli.catalogue",
    "challenge make": "tsas_studies.challenge.stages.make_set",
    "challenge run": "tsas_studies.challenge.stages.run_set",
    "challenge score": "tsas_studies.challenge.stages.score_set",
}
NEEDED_BESIDES = {
    "ingest": ("--map", "some", "--out", "some"),  # but for --guess
    "predict": ("some",),  # a model and a dataset
}
OTHERS = ("doctor", "init", "view")  # commands about the program itself and its window
STAGES = [name for name in CALLS if name not in OTHERS]
COLOUR = re.compile(r"\x1b\[[0-9;]*3[0-9]m")
BAR = """
import time
from tsas_cli.commands.common import progress
with progress("fit", quiet={quiet}) as step:
    step.ahead(2)
    step.say("f_in is not recorded")
    for k in range(4):
        time.sleep({pause_s})
        if k == 1:
            step.ahead(2)
        step()
print("the result")
"""


class Anything(Result):
    """What a stage may have found."""

    wrong = ()  # of files that `tsas verify` looks at
    failed = ()  # of tasks of `tsas sweep`

    def intro(self):
        return ["before the tables"]

    def tables(self):
        return [("a table", ("name", "value"), [("x", "1.5")])]

    def sentences(self):
        return ["- after the tables"]


class Opened:
    """A dataset that was opened, as far as a command itself looks at it."""

    class manifest:  # noqa: N801
        name = "some"


@pytest.fixture
def called(monkeypatch, capsys):
    """Call a command whose stage finds anything; return what it prints."""

    def call(name, *options):
        verb = VERBS.get(name, f"tsas_cli.{name.replace('-', '_')}")
        found = Anything(SUMMARY, None)
        monkeypatch.setattr("tsas_cli.read", lambda *_, **__: Opened(), raising=False)
        monkeypatch.setattr(verb, lambda *_, **__: found, raising=False)
        arguments = [*needed(CALLS[name]), *options]
        tsas_cli.app.app([*name.split(), *arguments], prog_name="tsas", standalone_mode=False)
        return capsys.readouterr()

    return call


def needed(command):
    """Return the words without which a command is no call."""
    words = []
    for parameter in command.params:
        if parameter.required:
            if parameter.param_type_name == "option":
                words.append(parameter.opts[0])
            words.append("1" if parameter.name == "seed" else "some")
    return [*words, *NEEDED_BESIDES.get(command.name, ())]


@pytest.mark.parametrize("name", STAGES)
def test_json_is_one_document_and_quiet_is_silent(called, name):
    output = called(name, "--json")
    assert json.loads(output.out) == SUMMARY
    assert output.err == ""
    assert called(name, "--quiet") == ("", "")


@pytest.mark.parametrize("name", STAGES)
def test_tables_and_sentences_are_the_result(called, name):
    output = called(name)
    words = ["before the tables", "a table", "name  value", "1.5", "- after the tables"]
    places = [output.out.find(word) for word in words]
    assert -1 not in places
    assert places == sorted(places)
    assert output.err == ""


def on_terminal(call, code=0, **environment):
    """Run a program whose standard error is a terminal; return what is said there and printed."""
    terminal, inside = pty.openpty()
    environment = os.environ | {"TERM": "xterm-256color", "COLUMNS": "120"} | environment
    environment.pop("TSAS_THREADS", None)
    call = {"args": call, "stdout": subprocess.PIPE, "stderr": inside, "env": environment}
    with subprocess.Popen(**call) as process:
        os.close(inside)
        said = read_from(terminal)
        printed = process.stdout.read()
    assert process.returncode == code
    return said, printed.decode()


def bar(quiet, pause_s=0.05, **environment):
    program = BAR.format(quiet=quiet, pause_s=pause_s)
    return on_terminal([sys.executable, "-c", program], **environment)


def test_a_bar_says_how_far_it_is_and_how_long_the_rest_takes():
    output, printed = bar(quiet=False, pause_s=0.4)
    assert COLOUR.search(output)
    assert not COLOUR.search(bar(quiet=False, NO_COLOR="1")[0])
    assert printed == "the result\n"
    counts = re.findall(r"(\d) of (\d)", output)
    assert ("1", "2") in counts  # two pieces were known to come …
    assert ("4", "4") in counts  # … and then two more
    assert "fit" in output
    assert "f_in is not recorded" in output
    assert re.search(r"about 0:00:0\d left", output)
    assert bar(quiet=True) == ("", "the result\n")


ENDED = """
import signal, sys
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.app import run
fit = Fits.fit
def stopped(self, *rest):
    fit(self, *rest)
    signal.raise_signal(signal.SIGINT)
Fits.fit = stopped
sys.argv = ["tsas", "diagnose", {dataset!r}, "--out", {out!r}]
run()
"""


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """Two short recordings of a rig with tendon outside the sheath, which a search finds."""
    rig = Rig(proximal_length_mm=150.0, cells=30)
    runs = {name: recorded(rig, 50.0, seed=k) for k, name in enumerate("ab")}
    return dataset_of(rig, tmp_path_factory.mktemp("searched") / "dataset", **runs)


def test_the_first_stop_ends_a_search(searched, tmp_path, monkeypatch):
    monkeypatch.delenv("MAKELEVEL", raising=False)
    out = tmp_path / "out"
    program = ENDED.format(dataset=str(searched), out=str(out))
    said, printed = on_terminal([sys.executable, "-c", program], code=EXIT_CODE)
    assert "Ctrl-C again stops at once" in said
    assert "leads so far" in said
    found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "undecided"
    # A signal comes after a step, and counts at the next.
    assert "ended after 2 fits" in found["reason"]
    assert len(found["candidates"]) == 2
    assert found["reason"] in printed


@pytest.mark.parametrize(("inside", "stops", "ended"), [(0, 1, 0), (0, 2, 1), (1, 1, 1)])
def test_a_search_is_stopped_by_the_second_stop_and_under_make_by_the_first(
    inside, stops, ended, monkeypatch
):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("MAKELEVEL", "1") if inside else monkeypatch.delenv("MAKELEVEL", False)
    with (
        pytest.raises(KeyboardInterrupt) if ended else nullcontext(),
        progress("fit", quiet=False, endable=True),
    ):
        for _ in range(stops):
            signal.raise_signal(signal.SIGINT)


def test_kernels_that_are_compiled_are_said(tmp_path):
    program = """
from tsas_cli.commands.common import progress
with progress("fit", quiet=False):
    from tsas_cli.numerics.elementary import exponential
    exponential(1.0)
"""
    cold = {"TSAS_CACHE_DIR": str(tmp_path)}
    assert "compiles numerical kernels" in on_terminal([sys.executable, "-c", program], **cold)[0]
    assert "compiles" not in on_terminal([sys.executable, "-c", program], **cold)[0]


def test_a_stage_shows_its_bar_on_a_terminal_and_prints_the_result(dataset):
    call = [sys.executable, "-m", "tsas_cli", "check", dataset]
    output, printed = on_terminal(call)
    assert "check" in output
    assert "1 of 1" in output
    assert printed.startswith("the checks found")
    assert "\x1b" not in printed


def test_help_has_no_colour_in_a_pipe_or_where_none_is_asked_for(monkeypatch):
    for name in ("FORCE_COLOR", "PY_COLORS", "GITHUB_ACTIONS"):
        monkeypatch.delenv(name, raising=False)
    call = [sys.executable, "-m", "tsas_cli", "check", "--help"]
    piped = subprocess.run(call, capture_output=True, text=True, check=True).stdout
    assert "\x1b" not in piped
    asked, _ = on_terminal(["sh", "-c", '"$@" >&2', "sh", *call], NO_COLOR="1")
    assert not COLOUR.search(asked)
    assert "DATASET" in piped
    assert "DATASET" in asked


def test_the_catalogue_says_at_a_terminal_what_tells_more():
    assert on_terminal([sys.executable, "-m", "tsas_cli", "effects"])[0].strip() == (
        "`tsas explain NAME` describes an effect"
    )
