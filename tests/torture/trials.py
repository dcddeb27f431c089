"""One trial: a stage is ended at a moment, what it leaves is judged, and it runs again."""

import random
import re
import shutil
import signal
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tests.torture.bench import Stage, faults_of, make_old, tree
from tests.torture.killing import Ended, Moment, call

TEMPORARY = re.compile(r"\..+\.[a-z0-9_]{8}\.tsas-(lock|new|old)")
GENTLE = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class Tried:
    """What became of a stage's trials."""

    stage: str
    operations: int = 0
    took_s: float = 0.0
    killed_at_operation: int = 0
    killed_at_time: int = 0
    stopped: int = 0
    ended_before: int = 0
    left_temporaries: int = 0
    findings: list[str] = field(default_factory=list)

    @property
    def ended(self) -> int:
        """How many calls were ended before they were done."""
        return self.killed_at_operation + self.killed_at_time + self.stopped


class Trials:
    """The trials of one stage in a folder that holds its inputs."""

    def __init__(self, home: Path, stage: Stage) -> None:
        self.home, self.stage = home, stage
        self.out, self.path = home / "out", home / stage.out
        self.inputs = tree(home / "in")
        self.tried = Tried(stage.name)
        self._clear()
        done = call(home, self._call())
        assert done.code == 0, done.said
        self.tried.operations = done.operations
        self.reference = home / f"reference-{stage.name}"
        shutil.move(self.path, self.reference)
        self.whole = tree(self.reference)
        self._clear()
        self.tried.took_s = call(home, self._call()).took_s  # now that all is loaded

    def moments(self, n: int, chance: random.Random) -> Iterator[Moment]:
        """Yield moments: half of them operations, spread evenly, the others times at random."""
        most, took_s = self.tried.operations, self.tried.took_s
        first = chance.random()
        for k in range(n):
            if k % 2 == 0:
                share = (k / n + first) % 1.0
                yield Moment(operation=1 + int(share * most))
            else:
                number = signal.SIGKILL if k % 8 != 5 else chance.choice(GENTLE)
                yield Moment(after_s=chance.uniform(0.0, took_s), number=number)

    def try_at(self, moment: Moment, *, old: bool) -> None:
        """End the stage at a moment, with an earlier result in its place or without."""
        self._clear()
        before: dict[str, str] | None = None
        if old and self.stage.forced:
            make_old(self.reference, self.path)
            before = tree(self.path)
        ended = call(self.home, self._call(force=before is not None), moment)
        self._count(ended, moment)
        faults = [*self._judged(before), *self._again()]
        where = f"{self.stage.name}, {moment}, {'over an old result' if before else 'new'}"
        self.tried.findings += [f"{where}: {fault}" for fault in faults]

    def _judged(self, before: dict[str, str] | None) -> Iterator[str]:
        """Yield what is wrong after the end: inputs bit-identical, outputs whole or absent."""
        if tree(self.home / "in") != self.inputs:
            yield "inputs have changed"
        for path in self.out.iterdir():
            if path == self.path:
                if before is None or tree(path) != before:
                    yield from faults_of(path, self.whole)
            elif TEMPORARY.fullmatch(path.name):
                self.tried.left_temporaries += path.name.endswith("lock")
            else:
                yield f"{path.name} stays"
        if before is not None and not self.path.exists():
            yield "the earlier result is gone"

    def _again(self) -> Iterator[str]:
        """Yield what is wrong after the next run: it works, and nothing else stays."""
        done = call(self.home, self._call(force=self.stage.forced))
        if done.code != 0:
            yield f"the next run ends with {done.code}: {done.said.strip()}"
        yield from faults_of(self.path, self.whole)
        if left := {path.name for path in self.out.iterdir()} - {self.path.name}:
            yield f"after the next run {', '.join(sorted(left))} stays"
        if tree(self.home / "in") != self.inputs:
            yield "the next run has changed inputs"

    def _count(self, ended: Ended, moment: Moment) -> None:
        if ended.code == -signal.SIGKILL:
            if moment.operation is None:
                self.tried.killed_at_time += 1
            else:
                self.tried.killed_at_operation += 1
        elif ended.code == 0:
            self.tried.ended_before += 1
        elif moment.number in GENTLE and ended.code in (130, -moment.number):
            self.tried.stopped += 1
        else:
            self.tried.findings.append(
                f"{self.stage.name}, {moment}: ends with {ended.code}: {ended.said.strip()}"
            )

    def _call(self, *, force: bool = False) -> tuple[str, ...]:
        return (*self.stage.call, *(["--force"] if force else []))

    def _clear(self) -> None:
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
