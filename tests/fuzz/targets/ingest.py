"""The whole of `tsas ingest`: a file's name, a map and a table, and nothing beside the output."""

from pathlib import Path

import tsas_cli
from tests.fuzz.documents import toml_document
from tests.fuzz.rules import Broken, Scratch, answer
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.stages import ingest as _ingest  # noqa: F401 # instrumented

SHARE = 2
MOST_BYTES = 3000
WORDS = (b"\n---\n", b"..", b"{folder}_{stem}", b'"first"', b"rate_Hz", b"offset", b"/../")
_BETWEEN = b"\n---\n"
_scratch = Scratch()
_home = _scratch.folder / "home"
_home.mkdir()


def one(data):
    """Beside the output folder nothing is written, and what is written can be read."""
    name, _, rest = data.partition(_BETWEEN)
    words, _, table = rest.partition(_BETWEEN)
    source = _home / (
        name.replace(b"/", b"").replace(b"\0", b"")[:60].decode("utf-8", "replace") + ".csv"
    )
    try:
        source.write_bytes(table)
    except (OSError, UnicodeError):
        return
    map_path, out = _scratch.file("map.toml", words), _scratch.folder / "out"
    result = answer(tsas_cli.ingest, source, map=map_path, out=out, force=True)
    try:
        if result is not None:
            _check(out)
        beside = {path.name for path in (*_scratch.folder.iterdir(), *_home.iterdir())}
        if beside - {"home", "map.toml", "out", source.name}:
            raise Broken(f"beside the output stand {sorted(beside)}")
    finally:
        source.unlink()


def _check(out: Path) -> None:
    dataset = read_dataset(out)
    written = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    if written != {"dataset.toml", *(run.file for run in dataset.manifest.run)}:
        raise Broken(f"the output holds {sorted(written)}")
    for recording in dataset:
        if len(recording.columns) < 2:
            raise Broken("a run without columns")


def mutate(data, most, seed):
    """Change one of the three parts."""
    from atheris import Mutate

    parts = data.split(_BETWEEN, 2)
    which = seed % 4 % len(parts)
    if which == 1:
        parts[1] = toml_document(parts[1], most, seed // 4)
    else:
        parts[which] = bytes(Mutate(parts[which], most))
    return _BETWEEN.join(parts)[:most]


def seeds():
    head = '[dataset]\nname = "a"\n'
    plain = head + '[columns]\ntime_s = {source = "t [s]"}\nx_in_mm = {source = "x [cm]"}\n'
    plain += 'f_in_N = {source = "f", unit = "V", factor = 10, factor_unit = "N"}\n'
    yield _BETWEEN.join((b"run 1", plain.encode(), b"t [s],x [cm],f\n0,1,2\n0.1,2,3\n0.2,3,nan\n"))
    numbered = head + "[read]\nextra = [3]\ndrop_repeated_rows = true\n[columns]\n"
    numbered += 'time_s = {rate_Hz = 100}\nx_in_mm = {source = 1, unit = "deg", '
    numbered += 'pulley_radius_mm = 5, sign = -1, offset = "first"}\n'
    numbered += 'f_in_N = {source = 2, unit = "lbf"}\n[run]\nid = "{stem}_{rig}"\n'
    numbered += "from_header = {pattern = 'rig (?P<rig>.*), (?P<preload_N>.*) N'}\n"
    numbered += "from_file_name = {pattern = '(?P<bend>[0-9]+)deg'}\n"
    numbered += 'conditions = {total_bend_rad = {from = "bend", unit = "deg"}}\n'
    yield _BETWEEN.join((b"90deg", numbered.encode(), b"# rig 3, 25,5 N\n1;2;3\n2;3;4\n2;3;4\n"))
