import json
import os

import pytest

from tsas_cli.installation import machine, packages
from tsas_cli.installation.packages import Extra, Package
from tsas_cli.support import __version__


@pytest.fixture
def doctor(here, monkeypatch):
    """Call the doctor on an installation that is described, not looked for."""
    monkeypatch.setattr(machine, "drawn_with", lambda: "Vulkan on a card")

    def call(*words, core=(), extras=()):
        monkeypatch.setattr(packages, "core_packages", lambda: iter(core))
        monkeypatch.setattr(packages, "extras", lambda: list(extras))
        return here("doctor", *words)

    return call


THERE = Package("numpy", ">=2.2", "2.4.6")
OLD = Package("scipy", ">=1.15", "1.9", "wrong version")
MISSING = Package("pint", ">=0.24", None, "missing")
MAT = Extra("mat", "MATLAB v7.3 files", (Package("h5py", ">=3.12", None, "missing"),))


def test_here_all_is_there_but_what_is_hidden(tsas, tmp_path):
    """It runs without the package that it finds missing."""
    (tmp_path / "pint").mkdir()
    (tmp_path / "pint" / "__init__.py").write_text("raise ImportError('hidden')")
    env = {"PYTHONPATH": str(tmp_path), "PYTHONWARNINGS": "error", "CI": "true"}
    result = tsas("doctor", "--json", env=os.environ | env)
    assert (result.returncode, result.stderr.count("\n")) == (2, 1)
    said = "cannot be loaded: ImportError: hidden"
    assert said in result.stderr
    summary = json.loads(result.stdout)
    assert summary["version"] == __version__
    found = {p["name"]: p["problem"] for p in summary["packages"]}
    assert {"Python", "numpy", "rerun-sdk", "packaging"} <= found.keys()
    assert {name: problem for name, problem in found.items() if problem} == {"pint": said}
    formats = {"mat", "hdf5", "mdf", "excel", "tdms", "robots"}
    extras = formats | {"challenge", "dask", "catalogue", "s3", "gs", "bench", "all"}
    assert {e["name"] for e in summary["extras"]} == extras
    names = ["compiled code", "threads", "viewer", "drawing", "screen", "Chromium"]
    assert [a["name"] for a in summary["machine"]] == names


def test_a_missing_extra_is_reported_with_its_command_and_is_no_failure(doctor):
    code, out, err = doctor(core=[THERE], extras=[MAT])
    assert (code, err) == (0, "")
    assert "-m pip install 'tsas[mat]'" in out
    assert "h5py" in out
    assert "pip install" not in doctor(core=[THERE], extras=[Extra("mat", "", (THERE,))])[1]


def test_what_is_needed_and_missing_is_one_line_with_the_command(doctor):
    code, out, err = doctor(core=[THERE, OLD, MISSING])
    assert code == 2
    assert out.startswith(f"tsas {__version__} on Python")
    assert err.startswith(
        "tsas: required packages are missing or wrong: scipy 1.9 wrong version, pint missing; "
    )
    assert err.endswith("-m pip install 'scipy>=1.15' 'pint>=0.24'\n")
    assert err.count("\n") == 1
    assert doctor("--quiet", core=[THERE, OLD, MISSING]) == (2, "", err)
    assert doctor("--quiet", core=[THERE], extras=[MAT]) == (0, "", "")


def test_the_command_can_be_pasted_where_python_lies_in_an_odd_folder(doctor, monkeypatch):
    monkeypatch.setattr("sys.executable", "/opt/my $(touch ran)/python")
    err = doctor(core=[OLD])[2]
    assert err.endswith("; '/opt/my $(touch ran)/python' -m pip install 'scipy>=1.15'\n")


def test_json_tells_all_of_it(doctor):
    code, out, _ = doctor("--json", core=[OLD], extras=[MAT])
    summary = json.loads(out)
    assert code == 2
    assert summary["packages"] == [
        {"name": "scipy", "asked": ">=1.15", "found": "1.9", "problem": "wrong version"}
    ]
    assert summary["extras"][0]["missing"] == ["h5py"]
    assert summary["extras"][0]["install"].endswith("pip install 'tsas[mat]'")
