"""The manifest of a dataset."""

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Broken, Scratch, answer
from tsas_cli.identification.model import data_sheet
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE, write_manifest

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 6
WORDS = (b"[[run]]", b"sha256", b"started = 2026-01-01T00:00:00Z", b"../", b"0" * 64, b"'''")
_scratch = Scratch()
_written = Scratch()


def one(data):
    """A manifest that is taken keeps its runs inside, and is the same when it is read again."""
    path = _scratch.file(MANIFEST_FILE, data)
    dataset = answer(read_dataset, path.parent)
    if dataset is None:
        return
    manifest = dataset.manifest
    for run in manifest.run:
        inside = (path.parent / run.file).resolve().is_relative_to(path.parent.resolve())
        if not inside or not run.id.isprintable():
            raise Broken(f"run {run.id!r} in {run.file!r}")
    answer(data_sheet, manifest)
    _ = manifest.session_start, manifest.unknown_keys(), manifest.rig.unknown_keys()
    dataset.header(path.parent)
    if len(data) % 4:  # writing takes several times as long as reading
        return
    write_manifest(_written.folder, manifest)
    again = read_dataset(_written.folder).manifest
    if repr(again) != repr(manifest):  # a nan is not equal to itself
        raise Broken(f"{manifest} is {again} when it is read again")


def seeds():
    run = f'[[run]]\nid = "a"\nfile = "runs/a.parquet"\nsha256 = "{"0" * 64}"\n'
    head = 'format = 1\nname = "bench"\nkind = "measured"\n'
    yield f"{head}{run}".encode()
    yield (
        f'{head}description = "d"\nlicense = "CC0"\nwhere = "lab"\n[rig]\n'
        "tendon_diameter_mm = 1.2\ntendon_modulus_GPa = 60\n"
        f"friction_coefficient = 0.1\nproximal_length_mm = 10\n{run}"
        "started = 2026-01-01T10:00:00\nsheath_length_mm = 785.0\ntotal_bend_rad = 3.1\n"
        'preload_N = 25.0\nload = "force"\nfrequency_Hz = 0.5\n'
        '[ingest]\nversion = "0.1.0"\n[ingest.map]\nfile = "map.toml"\n'
    ).encode()
