"""A local dataset on its way to object storage: recordings, lists of blocks, manifest last."""

from pathlib import Path

from tsas_cli.errors import InputError
from tsas_cli.recordings.blocks import SUFFIX, blocks_of
from tsas_cli.recordings.checked import changed, local_file
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import FILE, Run
from tsas_cli.recordings.storage import Address
from tsas_cli.steps import Steps


def upload_dataset(folder: Path, target: Address, *, force: bool, step: Steps) -> dict[str, int]:
    """Put a dataset at an address; return the size of each object [bytes].

    There is a dataset at the address once all of it is there: the manifest comes last, and an
    older one goes first.

    Raises
    ------
    InputError
        The dataset is wrong, one is at the address and `force` is not set, or the storage refuses.
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
        local_file(folder, run)
    if there:
        manifest.remove()
    sizes: dict[str, int] = {}
    for run in dataset.runs:
        sizes |= _upload_run(folder, run, target)
        step()
    content = (folder / FILE).read_bytes()
    manifest.write_bytes(content)
    return sizes | {FILE: len(content)}


def _upload_run(folder: Path, run: Run, target: Address) -> dict[str, int]:
    path = local_file(folder, run)
    blocks = blocks_of(path)
    if blocks.sha256 != run.sha256.lower():
        raise changed(path, run)
    (target / run.file).copy_from(path)
    listed = blocks.content()
    (target / f"{run.file}{SUFFIX}").write_bytes(listed)
    return {run.file: blocks.size, f"{run.file}{SUFFIX}": len(listed)}
