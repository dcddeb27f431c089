"""A small bench: recordings, what the stages made of them, and the calls that are killed."""

import hashlib
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.drives import drive_dataset
from tests.recordings.guess.rig_files import CHANNELS, run, write_csv
from tsas_cli.support.replacing import SUMS

NAMES = ("Time [s]", "Input position [mm]", "Output position [mm]", "Force in [N]", "Force out [N]")
DIFFERS = {SUMS, "stream.rrd"}  # a stream holds the time of its making
Run = Callable[..., int]


@dataclass(frozen=True)
class Stage:
    """A call of tsas; it writes `out/NAME`, and reads what `needs` and it name below `in/`."""

    name: str
    words: tuple[str, ...]
    out: str
    needs: tuple[str, ...] = ("dataset",)
    forced: bool = True

    @property
    def call(self) -> tuple[str, ...]:
        """The words of the call, without --force."""
        return (*self.words, "--quiet")


def _stage(name: str, words: str, *needs: str) -> Stage:
    rrd = () if name in ("compare", "predict") else ("--rrd",)
    return Stage(name, (name, *words.split(), "--out", f"out/{name}", *rrd), f"out/{name}", needs)


PAGE = ("dataset", "check", "calibrate", "simulate", "diagnose")
STAGES = (
    Stage("init", ("init", "out/init", "--from", "in/raw"), "out/init", (), forced=False),
    Stage("ingest", ("ingest", "in/raw", "--map", "in/map.toml", "--out", "out/data"), "out/data"),
    _stage("check", "in/dataset", "dataset"),
    _stage("calibrate", "in/dataset", "dataset"),
    _stage("simulate", "in/dataset --model in/calibrate", "dataset", "calibrate"),
    _stage("diagnose", "in/dataset --model in/calibrate", "dataset", "calibrate"),
    _stage("identify-harmonic-drive", "in/drive", "drive"),
    _stage("track", "--controller pid"),
    _stage("close-loop", "--cases bend --seeds 1"),
    Stage(
        "report",
        ("report", *(f"in/{name}" for name in PAGE), "--out", "out/report.html"),
        "out/report.html",
        PAGE,
    ),
    _stage("predict", "in/calibrate in/diagnose in/dataset", "dataset", "calibrate", "diagnose"),
    _stage("compare", "in/calibrate in/diagnose --on in/dataset", *PAGE),
)


def make_inputs(home: Path, stages: tuple[Stage, ...], tsas: Run) -> None:
    """Write below `in/` what the stages read; `tsas` runs the command line there."""
    (home / "in" / "raw").mkdir(parents=True)
    columns = [(name, run(20)[c]) for c, name in zip(CHANNELS, NAMES, strict=True)]
    write_csv(home / "in" / "raw" / "a.csv", columns)
    assert tsas("init", "project", "--from", "in/raw", "--quiet") == 0
    shutil.move(home / "project" / "bench.toml", home / "in" / "map.toml")
    shutil.rmtree(home / "project")
    assert tsas("ingest", "in/raw", "--map", "in/map.toml", "--out", "in/dataset", "--quiet") == 0
    needed = {name for stage in stages for name in stage.needs}
    if "drive" in needed:
        drive_dataset(home / "in" / "drive", only=("chirp",), duration_s=6.0)
    for name in PAGE[1:]:
        if name in needed | ({"calibrate"} if "simulate" in needed else set()):
            call = next(stage.call for stage in STAGES if stage.name == name)
            words = [word.replace("out/", "in/") for word in call if word != "--rrd"]
            assert tsas(*words) == 0, name


def tree(path: Path) -> dict[str, str]:
    """Return the checksum of every file below a path, or of itself, by its name in there."""
    files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
    return {
        os.path.relpath(file, path): hashlib.sha256(file.read_bytes()).hexdigest() for file in files
    }


def make_old(reference: Path, path: Path) -> None:
    """Put an earlier result, which differs from what the stage writes, under a name."""
    if reference.is_file():
        path.write_bytes(unsealed(reference) + b"<!-- earlier -->\n")
        return
    shutil.copytree(reference, path)
    first = next(p for p in sorted(path.rglob("*")) if p.is_file())
    first.write_bytes(unsealed(first) + b"\n")
    for sums in path.rglob(SUMS):
        name = first.relative_to(sums.parent).as_posix()
        lines = sums.read_text(encoding="utf-8").splitlines()
        digest = hashlib.sha256(first.read_bytes()).hexdigest()
        now = (f"{digest}  {name}" if line.endswith(f"  {name}") else line for line in lines)
        sums.write_text("".join(f"{line}\n" for line in now), encoding="utf-8")


def unsealed(file: Path) -> bytes:
    """Return the content of a file without the last line that tells whether it was edited."""
    lines = file.read_bytes().splitlines(keepends=True)
    return b"".join(lines[:-1] if lines and b"sha256 of all above" in lines[-1] else lines)


def faults_of(path: Path, reference: dict[str, str]) -> list[str]:
    """Return what is not whole of a result, beside one that was made in peace."""
    found = tree(path)
    faults = [f"{path} lacks {name}" for name in reference.keys() - found.keys()]
    faults += [f"{path} holds {name}" for name in found.keys() - reference.keys()]
    same = found.keys() & reference.keys()
    faults += [
        f"{path / name} differs"
        for name in same
        if Path(name).name not in DIFFERS and found[name] != reference[name]
    ]
    for sums in path.rglob(SUMS):
        for line in sums.read_text(encoding="utf-8").splitlines():
            digest, name = line.split("  ", 1)
            listed = str((sums.parent / name).relative_to(path))
            if found.get(listed) != digest:
                faults.append(f"{sums}: {name} does not fit")
    return faults
