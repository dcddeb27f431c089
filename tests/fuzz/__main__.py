"""Search every reader for input on which a rule is broken, one after the other; print one table."""

import argparse
import sys
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

import tests.fuzz.targets
from tests.fuzz.search import Budget, Found, keep, search
from tsas_cli.commands.common import show

CORPUS = Path(__file__).parent / "corpus"
HEADER = ("target", "executions", "a second", "inputs", "edges", "faults")
NAMES = tuple(sorted(module.name for module in iter_modules(tests.fuzz.targets.__path__)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the call, search, print; return 1 where something was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(NAMES)}; all where none is named")
    parser.add_argument(
        "--runs",
        type=int,
        default=-1,
        help="executions at most, of all targets together, by their SHARE",
    )
    parser.add_argument("--seconds", type=int, default=0, help="time of each target at most")
    parser.add_argument("--seed", type=int, default=1, help="of the search; 1 where none is given")
    parser.add_argument("--out", type=Path, default=Path("reports/fuzz"), metavar="FOLDER",
                        help="where faults and what was learned are kept")  # fmt: skip
    parser.add_argument("--keep", action="store_true", help="renew the corpus in tests/fuzz/corpus")
    call = parser.parse_args(arguments)
    unknown = set(call.names) - set(NAMES)
    if unknown:
        parser.error(f"no target {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    if call.runs < 0 and not call.seconds:
        parser.error("say how long: --runs or --seconds")
    targets = [target_of(name) for name in call.names or NAMES]
    shares = sum(target.SHARE for target in targets)
    found = []
    for target in targets:
        print(f"searching {target.__name__} …", file=sys.stderr, flush=True)
        runs = -1 if call.runs < 0 else round(call.runs * target.SHARE / shares)
        budget = Budget(runs, call.seconds, call.seed)
        found.append(search(target, budget, CORPUS, call.out))
        if call.keep:
            keep(target.__name__, CORPUS, call.out)
    table = ("what was searched", HEADER, [*rows(found)])
    show({}, [table], quiet=False, as_json=False)
    kept = [path for one in found for path in one.faults]
    if kept:
        print("\nInputs that break a rule, with what they do beside each:", *kept, sep="\n  ")
    return 1 if kept else 0


def target_of(name: str) -> ModuleType:
    """Return a target's module."""
    return import_module(f"tests.fuzz.targets.{name}")


def rows(found: Sequence[Found]) -> Iterable[list[str]]:
    """Return a row for each target, and the sum."""
    for one in found:
        yield [
            one.target.rpartition(".")[2],
            f"{one.executions}",
            f"{one.executions / max(one.seconds, 1e-3):.0f}",
            f"{one.inputs}",
            f"{one.edges}",
            f"{len(one.faults)}",
        ]
    sums = (sum(o.executions for o in found), sum(len(o.faults) for o in found))
    yield ["all", f"{sums[0]}", "", "", "", f"{sums[1]}"]


if __name__ == "__main__":
    sys.exit(main())
