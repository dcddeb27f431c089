"""One mutant in a copy of the tree: the tests that run its line, the quickest first."""

import hashlib
import json
import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from benchmarks.mutants.children import TIMED_OUT, pytest_in, run
from benchmarks.mutants.mutations import Mutant
from benchmarks.mutants.reach import Reach

COPIED = ("tsas_cli", "tests", "benchmarks", "datasets", "docs", "pyproject.toml")
START_S = 10.0  # of processor time: what a child takes before its first test, and more
QUICK_S = 0.2  # of processor time under coverage
FAILED = ("FAILED", "ERROR")
KILLED, SURVIVED, TIMED = "killed", "survived", "timed out"


@dataclass(frozen=True)
class Bench:
    """Some packages, the tests that may reach them, and how they are run.

    Kernels of `physics` run as plain Python: to compile a mutant takes a minute.
    """

    packages: tuple[str, ...]
    tests: tuple[str, ...]
    plain: bool
    limit_s: float  # of processor time of a test that judges
    patience_s: float  # of processor time of the tests that judge a mutant, together

    @property
    def environment(self) -> dict[str, str]:
        """Return what the tests' process is told."""
        return {"TSAS_PLAIN_PYTHON": "1" if self.plain else "0"}

    def sources(self, root: Path) -> list[str]:
        """Return the files that are mutated."""
        files = [f for p in self.packages for f in sorted((root / "tsas_cli" / p).rglob("*.py"))]
        return [file.relative_to(root).as_posix() for file in files]


BENCHES = (
    Bench(("physics",), ("tests/physics",), plain=True, limit_s=0.7, patience_s=6),
    Bench(
        ("identification", "diagnosis"),
        ("tests/identification", "tests/diagnosis"),
        plain=False,
        limit_s=3,
        patience_s=8,
    ),
    Bench(
        ("recordings/quality",), ("tests/recordings/quality",), plain=False, limit_s=3, patience_s=8
    ),
)


@dataclass(frozen=True)
class Workshop:
    """A folder with the copy of the tree, what its tests reach, and the kernels' machine code."""

    root: Path
    folder: Path

    @property
    def tree(self) -> Path:
        """Return the copy that is mutated."""
        return self.folder / "tree"

    def copy(self) -> None:
        """Bring the copy up to date; what is the same keeps its time, and so its machine code."""
        for name in COPIED:
            source = self.root / name
            files = [source] if source.is_file() else sorted(source.rglob("*"))
            for file in files:
                if file.is_file() and "__pycache__" not in file.parts:
                    copy = self.tree / file.relative_to(self.root)
                    if not copy.exists() or copy.read_bytes() != file.read_bytes():
                        copy.parent.mkdir(parents=True, exist_ok=True)
                        shutil.copyfile(file, copy)

    def child(self, bench: Bench, work: Callable[[], int], processor_s: float) -> tuple[int, str]:
        """Run work in the copy."""
        environment = bench.environment | {"TSAS_CACHE_DIR": str(self.folder / "kernels")}
        output = self.folder / "output.txt"
        return run(work, self.tree, output, environment, processor_s=processor_s)

    def look(self, bench: Bench) -> list[Path]:
        """Find out which tests reach which lines; return where that is written, by file of tests.

        What was found for the same tests and the same package is not sought again.
        """
        package = hashlib.sha256()
        for source in bench.sources(self.tree):
            package.update((self.tree / source).read_bytes())
        found = {}
        for folder in bench.tests:
            for tests in sorted((self.tree / folder).rglob("test_*.py")):
                digest = package.copy()
                digest.update(tests.read_bytes())
                name = tests.relative_to(self.tree).as_posix()
                file = f"{name.replace('/', '.')}-{digest.hexdigest()[:12]}.json"
                found[name] = self.folder / "reach" / file
        missing = {name: file for name, file in found.items() if not file.exists()}
        if missing:
            self._look(bench, missing)
        return list(found.values())

    def _look(self, bench: Bench, files: dict[str, Path]) -> None:
        (self.folder / "reach").mkdir(exist_ok=True)

        def work() -> int:
            sources = [f"tsas_cli/{package}/*" for package in bench.packages]
            plugin = Reach(self.folder / "coverage", sources, bench.limit_s)
            code = pytest_in(list(files), [plugin])
            plugin.write(files, self.tree)
            return code

        code, output = self.child(bench, work, processor_s=3600)
        (self.folder / f"look-{Path(bench.packages[0]).name}.txt").write_text(output)
        if code and not bench.plain:  # one that needs compiled code judges no plain mutant
            raise SystemExit(f"the tests of {bench.packages[0]} do not pass:\n{output[-3000:]}")

    @contextmanager
    def mutated(self, mutant: Mutant) -> Iterator[None]:
        """Have the mutant in the copy for a while; afterwards the file is as old as it was."""
        file = self.tree / mutant.path
        text, stamp = file.read_text(), file.stat()
        file.write_text(mutant.source(self.tree))
        try:
            yield
        finally:
            file.write_text(text)
            os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))

    def judge(self, bench: Bench, mutant: Mutant, reached: "Reached") -> tuple[str, str]:
        """Return what became of a mutant, and the test that killed it or why it is alive.

        Quick tests alone come first: to load the files of the others takes longer than they do.
        """
        tests = reached.tests(mutant, bench.patience_s)
        if not tests:
            return SURVIVED, "no test that is quick enough runs this line"
        quick = reached.quick(tests)
        with self.mutated(mutant):
            for part in (quick, [name for name in tests if name not in quick]):
                if part:
                    work = partial(pytest_in, ["-x", *part])
                    code, output = self.child(bench, work, START_S + 2.0 * bench.patience_s)
                    if code == TIMED_OUT:
                        return TIMED, ""
                    if code:
                        said = [line for line in output.splitlines() if line.startswith(FAILED)]
                        return KILLED, said[0] if said else output[-300:]
        return SURVIVED, f"{len(tests)} tests"


class Reached:
    """What is known of the tests of a package."""

    def __init__(self, files: list[Path], tree: Path) -> None:
        self._tree = tree
        self._times: dict[str, float] = {}
        self._lines: dict[str, dict[str, set[str]]] = {}
        for file in files:
            found = json.loads(file.read_text())
            self._times |= found["times_s"]
            for path, lines in found["lines"].items():
                known = self._lines.setdefault(path, {})
                for line, names in lines.items():
                    known.setdefault(line, set()).update(names)

    @cached_property
    def _files(self) -> dict[str, set[str]]:
        """The tests that run anything of a file."""
        return {path: set().union(*lines.values()) for path, lines in self._lines.items()}

    def _users(self, path: str) -> set[str]:
        """Return the tests that run anything of a file, or take from it, or of one that does."""
        module = path.removesuffix(".py").replace("/", ".")
        takes = re.compile(rf"from {re.escape(module)} import")
        users = {p for p in self._files if takes.search((self._tree / p).read_text())}
        files = {name.split("::")[0] for name in self._times}
        taking = {file for file in files if takes.search((self._tree / file).read_text())}
        direct = {name for name in self._times if name.split("::")[0] in taking}
        return direct.union(*(self._files.get(p, set()) for p in users | {path}))

    def tests(self, mutant: Mutant, patience_s: float) -> list[str]:
        """Return the tests that run a line, or use it where it runs on loading; quick ones first.

        Together they take no more than the patience, so that a mutant that changes no time never
        ends by it.
        """
        lines = self._lines.get(mutant.path, {})
        names = set().union(*(lines.get(str(line), set()) for line in mutant.lines))
        if not names - {""}:
            names = self._users(mutant.path) if "" in names else set()
        chosen, total = [], 0.0
        for name in sorted(names & set(self._times), key=self._times.__getitem__):
            total += self._times[name]
            if total < patience_s:
                chosen.append(name)
        return chosen

    def quick(self, tests: list[str]) -> list[str]:
        """Return those of some tests that take next to no time."""
        return [name for name in tests if self._times[name] < QUICK_S]
