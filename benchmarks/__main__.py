"""Run every benchmark of this folder, print one table, and write it as JSON."""

import argparse
import os
import platform
import sys
from collections.abc import Iterable
from dataclasses import asdict
from importlib import import_module, metadata
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import benchmarks
from benchmarks.row import Row
from tsas_cli.commands.common import show
from tsas_cli.files import new_file, write_json

HARNESS = {"__main__", "row", "timing"}
LIBRARIES = ("numba", "numpy", "pyarrow", "rerun-sdk", "scipy", "typer")


def main() -> None:
    """Read the call, measure, print and write."""
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
    summary = {"format": 1, "machine": machine(), "benchmarks": found}
    show(summary, [table(name, rows) for name, rows in found.items()], quiet=False, as_json=False)
    if call.out:
        with new_file(call.out, force=True) as path:
            write_json(path, summary)


def measured(name: str) -> list[dict[str, Any]]:
    """Run one benchmark; say on stderr which one, since some take a minute."""
    print(f"measuring {name} …", file=sys.stderr)
    rows: Iterable[Row] = import_module(f"benchmarks.{name}").measure()
    return [asdict(row) | {"holds": row.holds} for row in rows]


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
    main()
