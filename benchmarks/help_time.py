"""How long `tsas --help` takes, against a bare Typer app with one command, side by side."""

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.row import Row
from benchmarks.timing import Times

PAIRS = 25
BARE = """
import typer

app = typer.Typer()


@app.command()
def greet(name: str) -> None:
    print(name)


app()
"""
TSAS = "from tsas_cli.__main__ import main; main()"  # what the installed `tsas` does


def measure() -> Iterator[Row]:
    """Time both in turns, so that the load of the machine falls on both alike."""
    with tempfile.TemporaryDirectory() as folder:
        bare, tsas = (write(Path(folder), n, t) for n, t in (("bare", BARE), ("tsas", TSAS)))
        for program in (bare, tsas):
            seconds(program)  # the first start writes byte code
        pairs = [(seconds(tsas), seconds(bare)) for _ in range(PAIRS)]
    ours, theirs = (Times(column) for column in zip(*pairs, strict=True))
    yield Row.timed("tsas --help", ours, "ms", per_s=1e3)
    yield Row.timed("bare Typer app --help", theirs, "ms", per_s=1e3)
    yield Row("ratio, median of pairs", statistics.median(a / b for a, b in pairs), "", at_most=1.5)


def write(folder: Path, name: str, text: str) -> Path:
    """Write a program into a folder."""
    path = folder / f"{name}.py"
    path.write_text(text, encoding="utf-8")
    return path


def seconds(program: Path) -> float:
    """Return how long a program takes to print its help."""
    start = time.perf_counter()
    subprocess.run([sys.executable, program, "--help"], stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start
