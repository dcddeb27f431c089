"""A local dataset on its way to object storage: recordings, and the manifest last."""

from pathlib import Path

from tsas_cli.recordings.checked import changed, local_file
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import FILE, Run
from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_cli.support.steps import Steps


def upload_dataset(folder: Path, target: Address, *, force: bool, step: Steps) -> dict[str, int]:
    """Put a dataset at an address; return the size of each object [bytes].

    The manifest comes last. Until then an older one stands, whose checksums tell that its
    recordings are being replaced.

    Raises
    ------
    InputError
        The dataset is wrong, one is at the address and `force` is not set, a recording would
        replace what belongs to no dataset, or the storage refuses.
    """
    dataset = read_dataset(folder)
    manifest = target / FILE
    there = manifest.is_file()
    if there and not force:
        raise InputError(
            "already exists",
            where=manifest,
            expected="an address that is free",
            remedy="choose another, or replace it with --force",
        )
    step.ahead(len(dataset.runs))
    replaced = {run.file for run in read_dataset(target).runs} if there else set()
    for run in dataset.runs:  # before the first byte leaves, and before anything is replaced
        if run.file not in replaced:
            _refuse_foreign(target / run.file, local_file(folder, run).stat().st_size)
    sizes: dict[str, int] = {}
    for run in dataset.runs:
        sizes[run.file] = _upload_run(folder, run, target)
        step()
    content = (folder / FILE).read_bytes()
    manifest.write_bytes(content)
    return sizes | {FILE: len(content)}


def _refuse_foreign(there: Address, size: int) -> None:
    """Refuse to replace an object of another size than an upload that was cut off has put there."""
    if there.is_file() and there.size() != size:
        raise InputError(
            "was not put there by `tsas upload`",
            where=there,
            expected="an address that is free, or a dataset",
            remedy="choose another address, or remove the object with the storage's own tools",
        )


def _upload_run(folder: Path, run: Run, target: Address) -> int:
    path = local_file(folder, run)
    if sha256_of(path) != run.sha256.lower():
        raise changed(path, run)
    (target / run.file).copy_from(path)
    return path.stat().st_size
