"""A local dataset on its way to object storage: recordings, lists of blocks, manifest last."""

from pathlib import Path

from tsas_cli.recordings.blocks import SUFFIX, blocks_of
from tsas_cli.recordings.checked import changed, local_file
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import FILE, Run
from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import Steps


def upload_dataset(folder: Path, target: Address, *, force: bool, step: Steps) -> dict[str, int]:
    """Put a dataset at an address; return the size of each object [bytes].

    There is a dataset at the address once all of it is there: the manifest comes last, and an
    older one goes first.

    Raises
    ------
    InputError
        The dataset is wrong, one is at the address and `force` is not set or something else than
        an earlier upload, or the storage refuses.
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
    for run in dataset.runs:  # before the first byte leaves, and before anything is replaced
        _refuse_foreign(target, run, local_file(folder, run).stat().st_size)
    if there:
        for run in read_dataset(target).runs:
            _refuse_foreign(target, run)
        manifest.remove()
    sizes: dict[str, int] = {}
    for run in dataset.runs:
        sizes |= _upload_run(folder, run, target)
        step()
    content = (folder / FILE).read_bytes()
    manifest.write_bytes(content)
    return sizes | {FILE: len(content)}


def _refuse_foreign(target: Address, run: Run, size: int | None = None) -> None:
    """Refuse to replace an object that no upload has put there.

    One that an upload has put there has a list of its blocks beside it, or was cut off before that
    and has the size of what is uploaded now.
    """
    there = target / run.file
    listed = target / f"{run.file}{SUFFIX}"
    if there.is_file() and not listed.is_file() and there.size() != size:
        raise InputError(
            "was not put there by `tsas upload`",
            where=there,
            expected="an address that is free, or a dataset that it has uploaded",
            remedy="choose another address, or remove the object with the storage's own tools",
        )


def _upload_run(folder: Path, run: Run, target: Address) -> dict[str, int]:
    path = local_file(folder, run)
    blocks = blocks_of(path)
    if blocks.sha256 != run.sha256.lower():
        raise changed(path, run)
    (target / run.file).copy_from(path)
    listed = blocks.content()
    (target / f"{run.file}{SUFFIX}").write_bytes(listed)
    return {run.file: blocks.size, f"{run.file}{SUFFIX}": len(listed)}
