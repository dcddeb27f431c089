"""Manifests, maps and models: paths that lead out, names that bite, files that never end."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import MAP, TABLE, Make, cases, dataset, ingesting, manifest_text

Content = str | bytes | Callable[[], str]  # what is large is made when it is written


def manifest(content: Content) -> Make:
    """Return a maker of a dataset whose file is right and whose manifest says this."""

    def make(folder: Path) -> list[object]:
        dataset(folder)
        made = content() if callable(content) else content
        raw = made if isinstance(made, bytes) else made.encode("utf-8", "surrogatepass")
        digest = hashlib.sha256((folder / "runs/0.parquet").read_bytes()).hexdigest()
        (folder / "dataset.toml").write_bytes(raw.replace(b"0" * 64, digest.encode()))
        return ["check", folder]

    return make


def file(name: str) -> Make:
    return manifest(manifest_text(file=name))


def run_id(name: str) -> Make:
    return manifest(manifest_text(run=name))


def two_runs(one: str, other: str) -> Make:
    return manifest(manifest_text(run=one) + manifest_text(run=other).split("\n", 3)[3])


def also(lines: str) -> Make:
    """Return a maker of a dataset with more lines about its run."""
    return manifest(f"{manifest_text()}{lines}\n")


def linked(path: str, target: str) -> Make:
    """Return a maker of a dataset of which a part is a link; what it was is outside."""

    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        (folder / "d" / path).rename(folder / "outside")
        (folder / "d" / path).symlink_to(target)
        return ["check", folder / "d"]

    return make


def pipe(*words: str) -> Make:
    """Return a maker of a call that names a pipe that nobody writes to as `PIPE`."""

    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        (folder / "a.csv").write_text("t,x,f\n1,2,3\n")
        (folder / "map.toml").write_text(MAP)
        for name in ("pipe.toml", "pipe.csv", "pipe.parquet", "d/check.json"):
            os.mkfifo(folder / name)
        return [folder / word.lower() if word.isupper() else word for word in words]

    return make


def run_is_pipe(folder: Path) -> list[object]:
    dataset(folder)
    (folder / "runs/0.parquet").unlink()
    os.mkfifo(folder / "runs/0.parquet")
    return ["check", folder]


def many_runs(folder: Path) -> list[object]:
    runs = [manifest_text(f"{i}", f"{i}").split("\n", 3)[3] for i in range(100_000)]
    (folder / "dataset.toml").write_text(manifest_text().split("[[", 1)[0] + "".join(runs))
    return ["check", folder]


def huge(name: str, *call: str) -> Make:
    """Return a maker of a file of 4 GB that takes no room."""

    def make(folder: Path) -> list[object]:
        dataset(folder)
        with (folder / name).open("ab") as stream:
            stream.truncate(1 << 32)
        return [folder / word[1:] if word.startswith("@") else word for word in call]

    return make


def model(content: str | Callable[[], str]) -> Make:
    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        (folder / "m.toml").write_text(content() if callable(content) else content)
        return ["simulate", folder / "d", "--model", folder / "m.toml", "--out", folder / "o"]

    return make


def sources(folder: Path) -> list[object]:
    """A folder to ingest with loops, devices, pipes and one honest file."""
    place = folder / "in/deep"
    place.mkdir(parents=True)
    (place / "up").symlink_to("..")
    (place / "loop").symlink_to("loop")
    (place / "loop.csv").symlink_to("loop.csv")
    (place / "zero.csv").symlink_to("/dev/zero")
    os.mkfifo(place / "pipe.csv")
    (place / "a.csv").write_text(TABLE)
    (folder / "map.toml").write_text(MAP)
    return ["ingest", folder / "in", "--map", folder / "map.toml", "--out", folder / "out"]


def table(name: str = "a.csv", *, mapped: str = "") -> Make:
    """Return a maker of an honest table under this name, whose map has more lines."""

    def make(folder: Path) -> list[object]:
        (folder / name).write_text(TABLE)
        return ingesting(folder / name, MAP + mapped)

    return make


def named(pattern: str) -> Make:
    return table(mapped=f'[run]\nid = "{pattern}"\n')


def keys(count: int) -> str:
    """Return a manifest with so many keys of its own."""
    return manifest_text().replace(
        "[[run]]", "".join(f"k{i} = 1\n" for i in range(count)) + "[[run]]"
    )


def no_run(run: str) -> Make:
    return manifest(f'format = 1\nname = "x"\nkind = "measured"\nrun = {run}\n')


DEEP = ".".join(["a"] * 500) + " = 1\n"
CASES = cases(
    {
        "must stay inside the dataset's folder": {
            "a file in the folder above": file("../outside.parquet"),
        },
        "the run's file is missing": {
            "a file with NUL": file("runs/0.parquet\0"),
            "no file": file(""),
            "a link to /dev/zero": linked("runs/0.parquet", "/dev/zero"),
            "a link to itself": linked("runs/0.parquet", "0.parquet"),
            "a run that is a pipe": run_is_pipe,
        },
        "the checksum differs": {"the manifest as a run": file("dataset.toml")},
        "is too long for a file's name": {
            "a file of 10,000 letters": file("a" * 10_000),
            "a file of many folders": file("a/" * 50_000 + "a"),
        },
        "a link leads out of the dataset's folder": {
            "a link to a file outside": linked("runs/0.parquet", "../../outside"),
            "a folder that is a link": linked("runs", "../outside"),
            "a manifest that is a link": linked("dataset.toml", "../outside"),
            "a manifest that is /etc/passwd": linked("dataset.toml", "/etc/passwd"),
        },
        "no dataset.toml here": {
            "a manifest that is /dev/zero": linked("dataset.toml", "/dev/zero"),
            "a manifest that is a link to itself": linked("dataset.toml", "dataset.toml"),
        },
        "is a pipe or a device": {
            "a pipe as map": pipe("ingest", "A.CSV", "--map", "PIPE.TOML", "--out", "O"),
            "a pipe as recording": pipe("ingest", "PIPE.CSV", "--map", "MAP.TOML", "--out", "O"),
            "a pipe to guess at": pipe("ingest", "PIPE.CSV", "--guess"),
            "a pipe as model": pipe("simulate", "D", "--model", "PIPE.TOML", "--out", "O"),
            "a pipe as drive": pipe("track", "--drive", "PIPE.TOML", "--out", "O"),
            "a pipe as settings": pipe("track", "--settings", "PIPE.TOML", "--out", "O"),
            "a pipe as rig": pipe("plan", "PIPE.TOML"),
            "a device as map": pipe("ingest", "D", "--map", "/dev/zero", "--out", "O"),
            "a device as model": pipe("simulate", "D", "--model", "/dev/zero", "--out", "O"),
        },
        "does not exist": {
            "a pipe as reference": pipe("track", "--reference", "PIPE.PARQUET", "--out", "O"),
        },
        "nothing that can be compared is here": {
            "a pipe to compare": pipe("compare", "PIPE.TOML", "PIPE.TOML", "--out", "O"),
        },
        "must be usable as a file name": {
            "a run called ../x": run_id("../x"),
            "a run without a name": run_id(""),
            "a file called ..csv": table("..csv"),
            "an id that leads out": named("../../x"),
            "an id without end": named("{stem}" * 300),
            "an id with a line's end": named("a\\nb"),
        },
        "must be usable as a file name (no slash": {"a run with an escape": run_id("\x1b[2Jx")},
        "name one file on Windows and macOS": {
            "runs that differ in case only": two_runs("a", "A"),
            "runs that look alike": two_runs("\u00e9", "e\u0301"),
        },
        "holds 100000 runs; expected at most 50000": {"a hundred thousand runs": many_runs},
        "is larger than 16.8 MB": {
            "a manifest of 4 GB": huge("dataset.toml", "check", "@."),
            "a map of 4 GB": huge("m.toml", "ingest", "@.", "--map", "@m.toml", "--out", "@o"),
        },
        "holds 1000006 keys": {
            "a million keys": manifest(lambda: keys(1_000_000)),
            "a million keys in a model": model(lambda: keys(1_000_000)),
        },
        "10100 keys are unknown, at most 1000": {"ten thousand keys": manifest(keys(10_100))},
        "is nested too deep": {
            "arrays, 100,000 deep": manifest("a = " + "[" * 100_000),
            "tables, 100,000 deep": manifest("a = " + "{a=" * 100_000),
            "dotted keys, 100,000 deep": also(".".join(["a"] * 100_000) + " = 1"),
            "dotted keys, 500 deep": also(DEEP),
            "quoted dotted keys, 500 deep": also(" . ".join(["'a b'"] * 500) + " = 1"),
            "a model, 500 deep": model(f"format = 1\ndataset.{DEEP}"),
            "a map, 500 deep": table(mapped=f"[run.table.a]\n{DEEP}"),
        },
        "an integer has thousands of digits": {
            "an integer of 10^5 digits": also("preload_N = " + "1" * 100_000),
        },
        "should be a number": {
            "an integer of 4000 digits": also("preload_N = " + "1" * 4000),
            "a model with an integer of 4000 digits": model(
                "format = 1\n[parameters.preload_N]\nunit = 'N'\norigin = 'x'\nvalue = "
                + "1" * 4000
            ),
            "a map with an integer of 4000 digits": table(
                mapped="[run]\npreload_N = " + "1" * 4000
            ),
        },
        "should be a finite number": {"1e400": also("preload_N = 1e400")},
        "is not TOML": {
            "a key twice": also('id = "b"'),
            "UTF-16": manifest(manifest_text().encode("utf-16")),
            "NULs": also("\0"),
            "a lone surrogate": run_id("a\ud800"),
            "a lone surrogate in bytes": also("a = '\ud800'"),
            "a date beyond all": also("started = 9999-99-99"),
        },
        "at least 1 item": {"no runs": no_run("[]")},
        "run.0: input should be a table": {"runs that are no tables": no_run("[1]")},
        "is a device on Windows": {"a file called con.csv": table("con.csv")},
        "\\x1b[2Jx.csv: run id '\\x1b[2Jx' must be usable as a file name": {
            "a file with an escape": table("\x1b[2Jx.csv"),
        },
        "its name is not UTF-8": {
            "a file whose name is no text": table(os.fsdecode(b"a\xff.csv")),
        },
        "": {
            "a pipe as a stage's answer": pipe("report", "D", "--out", "O.HTML"),
            "a run with script": run_id("<script>alert(1)<script>"),
            "a mark of UTF-8": manifest("\ufeff" + manifest_text()),
            "a folder of loops, pipes and devices": sources,
        },
    }
)
