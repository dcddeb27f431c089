"""A program that only notes what it is asked for, and calls of make that say what ran."""

import os
import shutil
import subprocess
import time
from pathlib import Path

from tsas_cli.project.start import makefile

REPOSITORY = Path(__file__).parents[2]
MAKE = shutil.which("make")

# Writes every file that a pipeline waits for into --out, whole or, when told to fail, not at all.
PROGRAM = """#!/bin/sh
printf '%s\\0' $# "$@" >> '{log}'
[ "$1" = "$(cat '{fail}' 2>/dev/null)" ] && exit 2
stage=$1
while [ "$1" != --out ]; do shift; done
case $stage in
report) echo page > "$2" ;;
*) mkdir -p "$2"
   for name in dataset.toml check.json model.toml model-extended.toml simulation.json \\
               diagnosis.json predict.json drive.toml tracking.json closing.json index.html; do
       case $stage-$name in
       ingest-dataset.toml|check-check.json|calibrate-model.toml|simulate-simulation.json|\\
       diagnose-diagnosis.json|diagnose-model-extended.toml|identify-harmonic-drive-drive.toml|\\
       predict-predict.json|track-tracking.json|close-loop-closing.json|\\
       reproduce-index.html) echo x > "$2/$name" ;;
       esac
   done ;;
esac
"""
CHAIN = ["check", "calibrate", "simulate", "diagnose", "report"]


class Bench:
    """A folder with a program, a stamp of its sources, and calls of make that say what ran."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.log, self.fail = folder, folder / "log", folder / "fail"
        program = folder / "tsas"
        program.write_text(PROGRAM.format(log=self.log, fail=self.fail))
        program.chmod(0o755)
        for i, name in enumerate(("locked", "installed", "stamp")):
            (folder / name).touch()
            os.utime(folder / name, (i, i))
        (folder / "python").symlink_to(program)
        self.settings = [f"TSAS={program}", f"BIN={folder}", f"PROGRAM={folder / 'stamp'}"]
        self.settings += [f"INSTALLED={folder / 'installed'}", f"LOCKED={folder / 'locked'}"]

    def run(
        self, *words: str, cwd: Path = REPOSITORY, **environment: str
    ) -> subprocess.CompletedProcess[str]:
        """Call make; `calls` then says what the program was asked for."""
        self.log.write_text("")
        return subprocess.run(
            [str(MAKE), *words, *self.settings],
            cwd=cwd,
            env=os.environ | environment,
            capture_output=True,
            text=True,
            errors="surrogateescape",
            check=False,
        )

    def make(self, *words: str, cwd: Path = REPOSITORY, code: int = 0) -> list[str]:
        done = self.run(*words, cwd=cwd)
        assert done.returncode == code, done.stdout + done.stderr
        return [stage for stage, *_ in self.calls()]

    def calls(self) -> list[list[str]]:
        """Return the words of every call of the program."""
        words = os.fsdecode(self.log.read_bytes()).split("\0")
        calls = []
        while len(words) > 1:
            end = 1 + int(words[0])
            calls.append(words[1:end])
            words = words[end:]
        return calls

    def touch(self, path: str | Path) -> None:
        (self.folder / path).touch()

    def age(self, *folders: str) -> None:
        """Make everything that was made an hour older."""
        then = time.time() - 3600
        for folder in folders:
            for path in [self.folder / folder, *(self.folder / folder).rglob("*")]:
                os.utime(path, (then, then))


def project_in(folder: Path) -> Path:
    """Write a project without recordings, as `tsas init` does."""
    project = folder / "project"
    (project / "raw").mkdir(parents=True)
    (project / "bench.toml").touch()
    (project / "Makefile").write_text(makefile())
    return project
