"""Searches one target under atheris, which can do so only once in a process."""

import ctypes
import hashlib
import os
import resource
import shlex
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tests.fuzz.rules import Watch

PACKAGE = Path(__file__).parents[2] / "tsas_cli"
COMPILED = ("controllers", "effects", "numerics", "physics")  # by numba: not seen
MEMORY = 1 << 31  # bytes beyond those that the libraries take


class Faults:
    """Keeps the shortest input for each place where a rule was broken, and goes on."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shortest: dict[str, int] = {}

    def keep(self, data: bytes, error: BaseException) -> None:
        """Write the input, and what went wrong with it beside."""
        place = _place(error)
        if len(data) >= self.shortest.get(place, sys.maxsize):
            return
        name = hashlib.sha256(place.encode()).hexdigest()[:16]
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_bytes(data)
        told = "".join(traceback.format_exception(error))
        (self.folder / f"{name}.txt").write_text(told, encoding="utf-8", errors="replace")
        if place not in self.shortest:
            print(f"FAULT {place} -> {self.folder / name}", file=sys.stderr, flush=True)
        self.shortest[place] = len(data)


def _place(error: BaseException) -> str:
    """Return the kind of the fault, and the last line of this program that it went through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if str(PACKAGE) in f.filename] or list(frames)
    return f"{type(error).__name__} {Path(ours[-1].filename).name}:{ours[-1].lineno}"


def guarded(target: ModuleType, faults: Faults, watch: "Watch") -> Callable[[bytes], None]:
    """Return the target as the fuzzer calls it: what is raised is kept, and the search goes on."""

    def one(data: bytes) -> None:
        try:
            with watch.during():
                target.one(data)
        except Exception as error:  # noqa: BLE001 # every kind of them is what is looked for
            faults.keep(data, error)

    return one


def main() -> None:
    """`python -m tests.fuzz.child TARGET FOUND` and the arguments of libFuzzer."""
    import atheris

    name, found, *arguments = sys.argv[1:]
    with atheris.instrument_imports(include=["tsas_cli", "asammdf"], exclude=_compiled()):
        from tests.fuzz import foreign
        from tests.fuzz.rules import Watch

        target = import_module(name)
        foreign.here_too = True
    faults, watch = Faults(Path(found)), Watch()
    one = guarded(target, faults, watch)
    warm_up(target)
    _limit_memory()
    more: dict[str, Any] = {}
    if hasattr(target, "mutate"):
        more["custom_mutator"] = target.mutate
    again = shlex.join([sys.executable, "-m", "tests.fuzz.child", name, found])  # for merging
    atheris.Setup([again, *arguments], one, **more)
    ctypes.CDLL(None).on_exit(_leave, None)
    atheris.Fuzz()


def warm_up(target: ModuleType) -> None:
    """Try the seeds: what is loaded and compiled at the first use is written then."""
    for seed in target.seeds():
        with suppress(Exception):  # a search tries it again
            target.one(seed)


@ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.c_void_p)
def _leave(status: int, _: object) -> None:
    """End at once: libFuzzer leaves with Python's lock, for which threads of pyarrow may wait."""
    os._exit(status)


def _compiled() -> list[str]:
    files = [file for part in COMPILED for file in (PACKAGE / part).rglob("*.py")]
    return [".".join(f.relative_to(PACKAGE.parent).with_suffix("").parts) for f in files]


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    limit = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))


if __name__ == "__main__":
    main()
