"""No command replaces what it reads: all that write, each of their inputs, all places around."""

import shutil
from pathlib import Path

import pytest

import tsas_cli as tsas
from tests.drives import drive_dataset
from tests.test_app import CALLS as COMMANDS
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.model_file import write_model
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.files import sha256_of, write_json, write_sums
from tsas_studies.commands import app

SHIPPED = Path(__file__).parents[2] / "datasets"
HERE = "home/"  # inputs lie in folders of their own in it

# What each command that writes is called with; what begins with `home/` is read.
CALLS = {
    "ingest": ["home/raw/a.csv", "--map", "home/map/map.toml"],
    "ingest --guess": ["home/raw/a.csv"],
    "check": ["home/tracked"],
    "calibrate": ["home/tracked", "--model", "home/model/model.toml"],
    "identify-harmonic-drive": ["home/drive-chirp"],
    "simulate": ["home/tracked", "--model", "home/model/model.toml"],
    "diagnose": ["home/tracked", "--model", "home/model/model.toml"],
    "compare": ["home/model", "home/other/model.toml", "--on", "home/tracked"],
    "predict": ["home/model", "home/other/model.toml", "home/tracked"],
    "plan": ["home/tracked"],
    "export": ["home/model/model.toml", "--to", "json"],
    "track": [
        *("--model", "home/model/model.toml", "--plant", "home/other/model.toml"),
        *("--drive", "home/drive/drive.toml", "--settings", "home/settings/rig.toml"),
        *("--reference", "home/tracked/runs/pid-undisturbed.parquet"),
    ],
    "close-loop": ["--settings", "home/settings/rig.toml"],
    "sweep": ["simulate", "home/tracked", "--set", "model=home/model/model.toml"],
    "report": ["home/tracked", "home/simulated"],
    "reproduce": [],
    "challenge make": ["--seed", "1"],
    "challenge run": ["home/set"],
    "challenge score": ["home/set", "home/entry"],
}
# Parameters that name no file, of any command that writes.
NO_FILES = {"out", "force", "quiet", "as_json", "rrd", "live", "despite", "runs", "guess"}
NO_FILES |= {"dynamics", "speed", "to", "sheath_length_mm", "total_bend_rad", "preload_n"}
NO_FILES |= {"fit_own", "nodes", "controllers", "compare", "disturb", "as_printed", "seeds", "seed"}
NO_FILES |= {"cases", "hide", "each_run", "workers", "cluster", "pdf", "small", "kind", "rate"}
NO_FILES |= {"tool", "what", "conditions", "salt", "first_seed"}
FILES = {"sources", "map_path", "dataset", "model", "a", "b", "on", "path", "plant", "drive"}
FILES |= {"given", "settings", "reference", "datasets", "options", "folders", "sealed", "entries"}
WRITE_NO_FILE = {"verify", "view", "runs", "doctor", "effects", "explain"}
WITHOUT_FORCE = {"init", "upload"}  # nothing is overwritten; to an address alone


def test_every_command_and_every_parameter_is_looked_at():
    assert set(COMMANDS) == {*CALLS} - {"ingest --guess"} | WRITE_NO_FILE | WITHOUT_FORCE
    writing = [command for name, command in COMMANDS.items() if name in CALLS]
    assert {p.name for command in writing for p in command.params} == NO_FILES | FILES


FILES_OF_OTHERS = {
    "raw/a.csv": "t,x,f\n0,0,25\n1,1,26\n2,2,27\n3,3,28\n",
    "map/map.toml": '[dataset]\nname = "a"\n[columns]\n'
    'time_s = { source = "t", unit = "s" }\nx_in_mm = { source = "x", unit = "mm" }\n'
    'f_in_N = { source = "f", unit = "N" }\n',
    "settings/rig.toml": "",
    "entry/c/diagnosis.json": "{}",
}
INGESTED = """
format = 1
[[run]]
id = "a"
file = "a.csv"
[[run]]
id = "b"
file = "map.toml"
[ingest]
sources = { a = 1, b = 1 }
"""


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """Return a folder with what every command reads, each in a folder of its own."""
    home = tmp_path_factory.mktemp("inputs") / "home"
    tsas.track(out=home / "tracked", controllers="pid", settings={"reference": {"duration_s": 2.0}})
    drive_dataset(home / "drive-chirp", only=("chirp",), duration_s=4.0)
    tsas.identify_harmonic_drive(home / "drive-chirp", out=home / "drive")
    for name in ("model", "other"):
        (home / name).mkdir()
        sheet = data_sheet(read_dataset(SHIPPED / "paper-groups").manifest)
        write_model(home / name / "model.toml", sheet, version="0", dataset={})
    tsas.simulate(home / "tracked", out=home / "simulated", dynamics="static")
    for name, text in FILES_OF_OTHERS.items():
        (home / name).parent.mkdir(exist_ok=True, parents=True)
        (home / name).write_text(text)
    shutil.copytree(home / "tracked", home / "set" / "cases" / "c" / "dataset")
    return home


def made_by(stage: str, folder: Path) -> None:
    """Have a folder look as if the stage had written it."""
    if stage == "ingest":
        (folder / "dataset.toml").write_text(INGESTED)
        return
    for summary in folder.glob("*.json"):
        summary.unlink()
    write_json(folder / "own.json", {"stage": stage})
    write_sums(folder)


def called(call: str, out: Path, home: Path) -> list[str]:
    """Return the arguments of a call that writes over `out`."""
    given = [text.replace("home/", f"{home}/") for text in CALLS[call]]
    return [*call.split(), *given, "--out", str(out), *(["--force"] if call != "sweep" else [])]


def state(folder: Path) -> dict[Path, str]:
    return {path: sha256_of(path) for path in folder.rglob("*") if path.is_file()}


def places(call: str, home: Path) -> set[Path]:
    """Return each input of a call, what holds one, and what lies inside one."""
    found = set()
    for text in CALLS[call]:
        if HERE in text:
            path = home / text.rpartition(HERE)[2]
            found |= {path, path.parent, home, *(path.iterdir() if path.is_dir() else ())}
    return found


REFUSED = "is an input, and would be replaced|lies inside .*, which is an input"
REFUSED += "|^[^:]*: is a f(ile|older)|is no folder of an earlier sweep"
CASES = [call for call, given in CALLS.items() if any(HERE in text for text in given)]


@pytest.mark.parametrize("call", CASES)
def test_what_is_read_stays(inputs, tmp_path, call):
    for number, out in enumerate(sorted(places(call, inputs))):
        home = tmp_path / f"{number}" / "home"
        shutil.copytree(inputs, home)
        place = home / out.relative_to(inputs)
        if place.is_dir():
            made_by(call, place)
        before = state(home)
        with pytest.raises(tsas.InputError, match=REFUSED):
            app(called(call, place, home), standalone_mode=False)
        assert state(home) == before, (call, out)
