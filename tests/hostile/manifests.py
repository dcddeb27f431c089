"""Manifests, maps and models: paths that lead out, names that bite, files that never end."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import MAP, Case, dataset, ingesting, manifest_text

Made = Callable[[Path], list[object]]
Content = str | bytes | Callable[[], str]  # what is large is made when it is written


def manifest(content: Content, command: str = "check") -> Made:
    """Return a maker of a dataset whose file is right and whose manifest says this."""

    def make(folder: Path) -> list[object]:
        dataset(folder)
        made = content() if callable(content) else content
        raw = made if isinstance(made, bytes) else made.encode("utf-8", "surrogatepass")
        digest = hashlib.sha256((folder / "runs/0.parquet").read_bytes()).hexdigest()
        (folder / "dataset.toml").write_bytes(raw.replace(b"0" * 64, digest.encode()))
        return [command, folder]

    return make


def file(name: str) -> Made:
    return manifest(manifest_text(file=name))


def run_id(name: str) -> Made:
    return manifest(manifest_text(run=name))


def linked(target: str) -> Made:
    """Return a maker of a dataset whose run is a link."""

    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        path = folder / "d/runs/0.parquet"
        path.rename(folder / "outside.parquet")
        path.symlink_to(target)
        return ["check", folder / "d"]

    return make


def folder_link(folder: Path) -> list[object]:
    dataset(folder / "d")
    (folder / "d/runs").rename(folder / "outside")
    (folder / "d/runs").symlink_to("../outside")
    return ["check", folder / "d"]


def manifest_link(folder: Path) -> list[object]:
    dataset(folder / "d")
    (folder / "d/dataset.toml").rename(folder / "outside.toml")
    (folder / "d/dataset.toml").symlink_to("../outside.toml")
    return ["check", folder / "d"]


def manifest_is(target: str) -> Made:
    def make(folder: Path) -> list[object]:
        dataset(folder)
        (folder / "dataset.toml").unlink()
        (folder / "dataset.toml").symlink_to(target)
        return ["check", folder]

    return make


def pipe(*words: str) -> Made:
    """Return a maker of a call that names a pipe that nobody writes to as `PIPE`."""

    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        os.mkfifo(folder / "pipe.toml")
        (folder / "a.csv").write_text("t,x,f\n1,2,3\n")
        os.mkfifo(folder / "pipe.csv")
        (folder / "map.toml").write_text(MAP)
        os.mkfifo(folder / "pipe.parquet")
        os.mkfifo(folder / "d/check.json")
        return [folder / word.lower() if word.isupper() else word for word in words]

    return make


def run_is_pipe(folder: Path) -> list[object]:
    dataset(folder)
    (folder / "runs/0.parquet").unlink()
    os.mkfifo(folder / "runs/0.parquet")
    return ["check", folder]


def many_runs(folder: Path) -> list[object]:
    text = 'format = 1\nname = "x"\nkind = "measured"\n' + "".join(
        f'[[run]]\nid = "{i}"\nfile = "runs/{i}.parquet"\nsha256 = "{"0" * 64}"\n'
        for i in range(100_000)
    )
    (folder / "dataset.toml").write_text(text)
    return ["check", folder]


def huge(name: str, *call: str) -> Made:
    """Return a maker of a file of 4 GB that takes no room."""

    def make(folder: Path) -> list[object]:
        dataset(folder)
        with (folder / name).open("r+b" if (folder / name).exists() else "wb") as stream:
            stream.truncate(1 << 32)
        return [folder / word[1:] if word.startswith("@") else word for word in call]

    return make


def model(content: str | Callable[[], str]) -> Made:
    def make(folder: Path) -> list[object]:
        dataset(folder / "d")
        (folder / "m.toml").write_text(content() if callable(content) else content)
        return ["simulate", folder / "d", "--model", folder / "m.toml", "--out", folder / "o"]

    return make


def mapped(content: str) -> Made:
    def make(folder: Path) -> list[object]:
        path = folder / "a.csv"
        path.write_text("t,x,f\n" + "".join(f"{i},{i % 7},{i % 5}\n" for i in range(9)))
        return ingesting(path, content)

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
    text = "t,x,f\n" + "".join(f"{i},{i % 7},{i % 5}\n" for i in range(9))
    (place / "a.csv").write_text(text)
    (folder / "map.toml").write_text(MAP)
    return ["ingest", folder / "in", "--map", folder / "map.toml", "--out", folder / "out"]


def named(name: str, run: str = "") -> Made:
    """Return a maker of an honest table under a hostile file name."""

    def make(folder: Path) -> list[object]:
        path = folder / name
        path.write_text("t,x,f\n" + "".join(f"{i},{i % 7},{i % 5}\n" for i in range(9)))
        return ingesting(path, MAP + run)

    return make


def keys(count: int) -> str:
    return "".join(f"k{i} = 1\n" for i in range(count))


RUN = '[run]\nid = "{}"\n'
CASES = (
    Case(
        "a file in the folder above",
        file("../outside.parquet"),
        "must stay inside the dataset's folder",
    ),
    Case("a file with NUL", file("runs/0.parquet\0"), "the run's file is missing"),
    Case("the manifest as a run", file("dataset.toml"), "the checksum differs"),
    Case("a file of 10,000 letters", file("a" * 10_000), "is too long for a file's name"),
    Case("a file of many folders", file("a/" * 50_000 + "a"), "is too long for a file's name"),
    Case("no file", file(""), "the run's file is missing"),
    Case(
        "a link to a file outside",
        linked("../../outside.parquet"),
        "a link leads out of the dataset's folder",
    ),
    Case("a link to /dev/zero", linked("/dev/zero"), "the run's file is missing"),
    Case("a link to itself", linked("0.parquet"), "the run's file is missing"),
    Case("a folder that is a link", folder_link, "a link leads out of the dataset's folder"),
    Case("a manifest that is a link", manifest_link, "a link leads out of the dataset's folder"),
    Case("a manifest that is /dev/zero", manifest_is("/dev/zero"), "no dataset.toml here"),
    Case(
        "a manifest that is a link to itself", manifest_is("dataset.toml"), "no dataset.toml here"
    ),
    Case(
        "a manifest that is /etc/passwd",
        manifest_is("/etc/passwd"),
        "a link leads out of the dataset's folder",
    ),
    Case("a run that is a pipe", run_is_pipe, "the run's file is missing"),
    Case(
        "a pipe as map",
        pipe("ingest", "A.CSV", "--map", "PIPE.TOML", "--out", "O"),
        "is a pipe or a device",
    ),
    Case(
        "a pipe as recording",
        pipe("ingest", "PIPE.CSV", "--map", "MAP.TOML", "--out", "O"),
        "is a pipe or a device",
    ),
    Case("a pipe to guess at", pipe("ingest", "PIPE.CSV", "--guess"), "is a pipe or a device"),
    Case(
        "a pipe as model",
        pipe("simulate", "D", "--model", "PIPE.TOML", "--out", "O"),
        "is a pipe or a device",
    ),
    Case(
        "a pipe as drive",
        pipe("track", "--drive", "PIPE.TOML", "--out", "O"),
        "is a pipe or a device",
    ),
    Case(
        "a pipe as settings",
        pipe("track", "--settings", "PIPE.TOML", "--out", "O"),
        "is a pipe or a device",
    ),
    Case(
        "a pipe as reference",
        pipe("track", "--reference", "PIPE.PARQUET", "--out", "O"),
        "does not exist",
    ),
    Case("a pipe as rig", pipe("plan", "PIPE.TOML"), "is a pipe or a device"),
    Case(
        "a pipe to compare",
        pipe("compare", "PIPE.TOML", "PIPE.TOML", "--out", "O"),
        "nothing that can be compared is here",
    ),
    Case("a pipe as a stage's answer", pipe("report", "D", "--out", "O.HTML")),
    Case(
        "a device as map",
        lambda f: ["ingest", f, "--map", "/dev/zero", "--out", f / "o"],
        "is a pipe or a device",
    ),
    Case(
        "a device as model",
        lambda f: ["simulate", dataset(f), "--model", "/dev/zero", "--out", f / "o"],
        "is a pipe or a device",
    ),
    Case("a run called ../x", run_id("../x"), "must be usable as a file name"),
    Case("a run without a name", run_id(""), "must be usable as a file name"),
    Case("a run with an escape", run_id("\x1b[2Jx"), "must be usable as a file name (no slash"),
    Case("a run with script", run_id("<script>alert(1)<script>")),
    Case(
        "runs that differ in case only",
        manifest(manifest_text() + manifest_text(run="A").split("\n", 3)[3]),
        "name one file on Windows and macOS",
    ),
    Case(
        "runs that look alike",
        manifest(manifest_text(run="\u00e9") + manifest_text(run="e\u0301").split("\n", 3)[3]),
        "name one file on Windows and macOS",
    ),
    Case("a hundred thousand runs", many_runs, "holds 100000 runs; expected at most 50000"),
    Case("a manifest of 4 GB", huge("dataset.toml", "check", "@."), "is larger than 16.8 MB"),
    Case(
        "a map of 4 GB",
        huge("m.toml", "ingest", "@.", "--map", "@m.toml", "--out", "@o"),
        "is larger than 16.8 MB",
    ),
    Case(
        "a million keys",
        manifest(lambda: manifest_text().replace("[[run]]", keys(1_000_000) + "[[run]]")),
        "holds 1000006 keys",
    ),
    Case(
        "a million keys in a model",
        model(lambda: "format = 1\n" + keys(1_000_000)),
        "holds 1000001 keys",
    ),
    Case(
        "ten thousand keys",
        manifest(manifest_text().replace("[[run]]", keys(10_100) + "[[run]]")),
        "10100 keys are unknown, at most 1000",
    ),
    Case("arrays, 100,000 deep", manifest("a = " + "[" * 100_000), "is nested too deep"),
    Case("tables, 100,000 deep", manifest("a = " + "{a=" * 100_000), "is nested too deep"),
    Case(
        "dotted keys, 100,000 deep",
        manifest(manifest_text() + ".".join(["a"] * 100_000) + " = 1\n"),
        "is nested too deep",
    ),
    Case(
        "dotted keys, 500 deep",
        manifest(manifest_text() + ".".join(["a"] * 500) + " = 1\n"),
        "is nested too deep",
    ),
    Case(
        "quoted dotted keys, 500 deep",
        manifest(manifest_text() + " . ".join(["'a b'"] * 500) + " = 1\n"),
        "is nested too deep",
    ),
    Case(
        "an integer of 10^5 digits",
        manifest(manifest_text() + "preload_N = " + "1" * 100_000 + "\n"),
        "an integer has thousands of digits",
    ),
    Case(
        "an integer of 4000 digits",
        manifest(manifest_text() + "preload_N = " + "1" * 4000 + "\n"),
        "should be a valid number",
    ),
    Case("1e400", manifest(manifest_text() + "preload_N = 1e400\n"), "should be a finite number"),
    Case("a key twice", manifest(manifest_text() + 'id = "b"\n'), "is not TOML"),
    Case("a mark of UTF-8", manifest("\ufeff" + manifest_text())),
    Case("UTF-16", manifest(manifest_text().encode("utf-16")), "is not TOML"),
    Case("NULs", manifest(manifest_text() + "\0"), "is not TOML"),
    Case("a lone surrogate", manifest(manifest_text(run="a\ud800")), "is not TOML"),
    Case(
        "a lone surrogate in bytes",
        manifest(manifest_text().replace("measured", "measured\ud800")),
        "is not TOML",
    ),
    Case("a date beyond all", manifest(manifest_text() + "started = 9999-99-99\n"), "is not TOML"),
    Case(
        "no runs",
        manifest('format = 1\nname = "x"\nkind = "measured"\nrun = []\n'),
        "at least 1 item",
    ),
    Case(
        "runs that are no tables",
        manifest('format = 1\nname = "x"\nkind = "measured"\nrun = [1]\n'),
        "run.0: input should be a valid dictionary",
    ),
    Case(
        "a model with an integer of 4000 digits",
        model(
            "format = 1\n[parameters.preload_N]\nunit = 'N'\norigin = 'x'\nvalue = " + "1" * 4000
        ),
        "should be a valid number",
    ),
    Case(
        "a model, 500 deep",
        model("format = 1\ndataset." + ".".join(["a"] * 500) + " = 1\n"),
        "is nested too deep",
    ),
    Case(
        "a map, 500 deep",
        mapped(MAP + "[run.table.a]\n" + ".".join(["a"] * 500) + " = 1\n"),
        "is nested too deep",
    ),
    Case(
        "a map with an integer of 4000 digits",
        mapped(MAP + "[run]\npreload_N = " + "1" * 4000),
        "should be a valid number",
    ),
    Case("a folder of loops, pipes and devices", sources),
    Case("a file called ..csv", named("..csv"), "must be usable as a file name"),
    Case("a file called con.csv", named("con.csv"), "is a device on Windows"),
    Case(
        "a file with an escape",
        named("\x1b[2Jx.csv"),
        "\\x1b[2Jx.csv: id: must be usable as a file name",
    ),
    Case("a file whose name is no text", named(os.fsdecode(b"a\xff.csv")), "its name is not UTF-8"),
    Case(
        "an id that leads out",
        named("a.csv", RUN.replace("{}", "../../x")),
        "must be usable as a file name",
    ),
    Case(
        "an id without end",
        named("a.csv", RUN.replace("{}", "{stem}" * 300)),
        "must be usable as a file name",
    ),
    Case(
        "an id with a line's end",
        named("a.csv", RUN.replace("{}", "a\\nb")),
        "must be usable as a file name",
    ),
)
