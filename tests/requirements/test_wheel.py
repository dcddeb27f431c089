"""The wheel: the same bytes each time, and a whole run from it in an environment of its own."""

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from requirements.locked import LOCK, ROOT

GROUPS = ROOT / "datasets" / "paper-groups"


def built(folder: Path) -> Path:
    call = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(call, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def test_it_is_the_same_bytes_each_time_and_holds_what_is_read(tmp_path):
    first, second = (built(tmp_path / name) for name in ("a", "b"))
    assert first.read_bytes() == second.read_bytes()
    held = zipfile.ZipFile(first).namelist()
    tracked = ["git", "ls-files", "tsas_cli", "tsas_studies"]
    files = subprocess.run(tracked, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert [name for name in files.splitlines() if name not in held] == []
    others = [name for name in held if not name.startswith(("tsas_cli/", "tsas_studies/", "tsas-"))]
    assert others == []


@pytest.mark.large
def test_a_whole_run_from_it_in_an_empty_environment(tmp_path):
    """With the locked versions; neither the repository nor this environment is seen."""
    wheel, home = built(tmp_path / "wheel"), tmp_path / "venv"
    venv.create(home, with_pip=True)
    versions = tmp_path / "versions.txt"
    lines = [line for line in LOCK.read_text().splitlines() if "==" in line]
    versions.write_text("".join(line.rstrip("\\ ") + "\n" for line in lines))
    pip = [home / "bin" / "python", "-m", "pip", "-qq", "--no-input", "install"]
    subprocess.run([*pip, "--constraint", versions, wheel], check=True)
    unseen = {"PYTHONPATH", "VIRTUAL_ENV", "PYTHONHOME"}
    environment = {name: value for name, value in os.environ.items() if name not in unseen}

    def tsas(*words):
        call = [home / "bin" / "tsas", *map(str, words)]
        done = subprocess.run(
            call, cwd=tmp_path, env=environment, check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "diagnose" in tsas("--help")
    doctor = tsas("doctor")
    assert "tsas[excel]" in doctor  # an extra that is missing, with its command
    tsas("check", GROUPS, "--out", "check")
    tsas("calibrate", GROUPS, "--out", "model")
    tsas("simulate", GROUPS, "--model", "model/model.toml", "--out", "simulate")
    assert "free_tendon" in tsas("diagnose", GROUPS, "--out", "diagnose")
    tsas("report", GROUPS, "check", "model", "simulate", "diagnose", "--out", "report.html")
    assert "tendon outside the sheath" in (tmp_path / "report.html").read_text(encoding="utf-8")
