"""What a shell completes, and that it does not wait for a library."""

import json
import subprocess
import sys

import pytest
import typer

from tests.test_app import HEAVY
from tsas_cli.commands import completion
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.effects import EFFECTS
from tsas_cli.tracking import SHAPE_NAMES
from tsas_cli.tracking.references import SHAPES

COMPLETED = """
import atexit, json, sys
atexit.register(lambda: print(json.dumps(sorted(sys.modules)), file=sys.stderr))
from tsas_cli.__main__ import main
main()
"""


@pytest.fixture
def offered_runs(tmp_path):
    """Return a function that writes a manifest and gives the runs that may follow a text."""
    context = typer.Context(typer.main.get_command(typer.Typer(callback=lambda: None)))
    context.args = [str(tmp_path)]

    def offered(manifest, begun=""):
        (tmp_path / "dataset.toml").write_text(manifest)
        return completion.run_ids(context, begun)

    return offered


def completed(monkeypatch, *words):
    """Return what bash is offered for the last word, and the modules that were loaded for it."""
    monkeypatch.setenv("_TSAS_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", " ".join(map(str, ("tsas", *words))))
    monkeypatch.setenv("COMP_CWORD", str(len(words)))
    call = [sys.executable, "-c", COMPLETED]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    return done.stdout.split(), {name.split(".")[0] for name in json.loads(done.stderr)}


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("explain", "drive_r"), ["drive_ripple"]),
        (("explain", "free_"), ["free_tendon"]),
        (("track", "--controller", "pid,s"), ["pid,sliding-mode"]),
        (("track", "--reference", "s"), ["sine", "steps"]),
        (("simulate", "--dynamics", "l"), ["lugre"]),
        (("cal",), ["calibrate"]),
    ],
)
def test_bash_is_offered_what_can_follow(monkeypatch, words, offered):
    found, loaded = completed(monkeypatch, *words)
    assert found == offered
    assert loaded & HEAVY <= {"pydantic"}  # which typer loads for every call


def test_runs_are_those_of_the_dataset_that_was_named(monkeypatch, dataset):
    assert completed(monkeypatch, "calibrate", dataset, "--runs", "")[0] == ["a"]
    assert completed(monkeypatch, "calibrate", dataset.parent, "--runs", "a")[0] == []


def test_a_run_that_a_shell_would_read_as_more_than_a_word_is_not_offered(offered_runs):
    odd = (r"\$(touch ran)", "`touch ran`", "a;b", "a b", "a'", "a|b", "$x", "*")
    runs = "\n".join(f"[[run]]\nid = {json.dumps(name)}" for name in ("bend-90_1.5", "Ü", *odd))
    assert offered_runs(runs) == ["bend-90_1.5", "Ü"]
    assert offered_runs(runs, r"\$") == []


def test_the_lists_are_those_of_the_program_but_for_what_is_named_already():
    assert completion.controllers("pid,") == [f"pid,{name}" for name in ("all", *CONTROLLERS[1:])]
    assert completion.effect_names("") == sorted(effect.name for effect in EFFECTS)
    assert tuple(SHAPES) == SHAPE_NAMES


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_gets_instructions(tsas, shell):
    environment = {"_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = tsas("--show-completion", shell, env=environment)
    assert done.returncode == 0
    assert "_TSAS_COMPLETE" in done.stdout


@pytest.mark.parametrize(
    "manifest", ["run = 1", "a = " + "[" * 5000, "a." * 200 + "a = 1", "[[run]]\n" * 60_000]
)
def test_a_manifest_that_cannot_be_read_offers_nothing(offered_runs, manifest):
    assert offered_runs(manifest) == []
