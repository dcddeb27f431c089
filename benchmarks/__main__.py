"""Run every benchmark of this folder, print one table, and write it as JSON.

`python -m benchmarks compare OLD NEW` says what got slower from one such file to another.
"""

import argparse
import os
import platform
import sys
from dataclasses import asdict
from importlib import import_module, metadata
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import benchmarks
from benchmarks.compare import FORMAT, compare
from benchmarks.row import Row
from benchmarks.timing import Times
from tsas_cli.commands.common import show
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_file, write_json

HARNESS = {"__main__", "compare", "row", "timing", "yardstick"}
LIBRARIES = ("numba", "numpy", "pyarrow", "rerun-sdk", "scipy", "typer")


def main() -> int:
    """Measure or compare, as the call says; return the exit code."""
    try:
        return compared(sys.argv[2:]) if sys.argv[1:2] == ["compare"] else measure()
    except InputError as error:
        print(f"benchmarks: {error.line()}", file=sys.stderr)
        return 2


def compared(files: list[str]) -> int:
    """Print what got slower; return 1 where something did."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks compare")
    parser.add_argument("old", type=Path, help="what an earlier call wrote with --out")
    parser.add_argument("new", type=Path, help="what a later one did")
    call = parser.parse_args(files)
    found = compare(call.old, call.new)
    show({}, found.tables(), quiet=False, as_json=False)
    return 1 if found.slower else 0


def measure() -> int:
    """Read the call, measure, print and write."""
    from benchmarks.yardstick import VERSION

    modules = [module for module in iter_modules(benchmarks.__path__) if not module.ispkg]
    known = sorted({module.name for module in modules} - HARNESS)
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(known)}; all where none is named")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the JSON file to write")
    call = parser.parse_args()
    unknown = set(call.names) - set(known)
    if unknown:
        parser.error(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(known)}")

    found = {name: measured(name) for name in call.names or known}
    summary = {
        "format": FORMAT,
        "machine": machine(),
        "yardstick": VERSION,
        "benchmarks": found,
    }
    tables = [table(name, told["rows"]) for name, told in found.items()]
    show(summary, tables, quiet=False, as_json=False)
    if call.out:
        with new_file(call.out, mark=b'"yardstick"', inputs=(), force=True) as path:
            write_json(path, summary)
    return 0


def measured(name: str) -> dict[str, Any]:
    """Run one benchmark between two looks at the yardstick; say which, since some take a minute."""
    from benchmarks.yardstick import yardstick

    print(f"measuring {name} …", file=sys.stderr)
    before = yardstick()
    rows: list[Row] = list(import_module(f"benchmarks.{name}").measure())
    beside = Times(before.seconds + yardstick().seconds)
    told = [asdict(row) | {"kind": row.compared_as, "holds": row.holds} for row in rows]
    return {"yardstick_s": [beside.least, beside.median, beside.largest], "rows": told}


def machine() -> dict[str, Any]:
    """Return what the figures depend on: processor, load before, Python and libraries."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "load_one_minute": os.getloadavg()[0],
        "python": platform.python_version(),
        "libraries": {name: metadata.version(name) for name in LIBRARIES},
    }


def processor() -> str:
    """Return the processor's name, as far as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def table(name: str, rows: list[dict[str, Any]]) -> tuple[str, list[str], list[list[str]]]:
    """Return a benchmark's rows as the table to print."""
    verdicts = {None: "", True: "yes", False: "NO"}
    cells = [
        [
            row["name"],
            f"{row['value']:.4g}",
            row["unit"],
            *("" if row[limit] is None else f"{row[limit]:g}" for limit in ("at_least", "at_most")),
            verdicts[row["holds"]],
        ]
        for row in rows
    ]
    return name, ["what", "value", "unit", "at least", "at most", "holds"], cells


if __name__ == "__main__":
    sys.exit(main())
