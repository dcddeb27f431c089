"""Upload of a local dataset to object storage: recordings, and the manifest last."""

from pathlib import Path

from tsas_cli.recordings.checked import changed, local_file
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE, Run
from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_cli.support.steps import Steps


def upload_dataset(folder: Path, target: Address, *, force: bool, step: Steps) -> dict[str, int]:
    """Write a dataset to an address; return the size of each object [bytes] by name.

    The manifest comes last. Until then the checksums of an older manifest reveal that its
    recordings are being replaced.

    Raises
    ------
    InputError
        The dataset is invalid, the address holds one and `force` is not set, a recording would
        replace an object of no dataset, or the storage fails.
    """
    dataset = read_dataset(folder)
    manifest = target / MANIFEST_FILE
    exists = manifest.is_file()
    if exists and not force:
        raise InputError(
            "already exists",
            where=manifest,
            expected="an address that is free",
            remedy="choose another, or replace it with --force",
        )
    step.ahead(len(dataset.runs))
    replaced = {run.file for run in read_dataset(target).runs} if exists else set()
    for run in dataset.runs:  # before anything is sent or replaced
        if run.file not in replaced:
            _refuse_foreign(target / run.file, local_file(folder, run).stat().st_size)
    sizes: dict[str, int] = {}
    for run in dataset.runs:
        sizes[run.file] = _upload_run(folder, run, target)
        step()
    content = (folder / MANIFEST_FILE).read_bytes()
    manifest.write_bytes(content)
    return sizes | {MANIFEST_FILE: len(content)}


def _refuse_foreign(existing: Address, size: int) -> None:
    """Refuse to replace an object, unless an interrupted upload of this size wrote it."""
    if existing.is_file() and existing.size() != size:
        raise InputError(
            "was not written by `tsas upload`",
            where=existing,
            expected="an address that is free, or a dataset",
            remedy="choose another address, or remove the object with the storage's own tools",
        )


def _upload_run(folder: Path, run: Run, target: Address) -> int:
    path = local_file(folder, run)
    if sha256_of(path) != run.sha256.lower():
        raise changed(path, run)
    (target / run.file).copy_from(path)
    return path.stat().st_size
