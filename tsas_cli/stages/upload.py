"""Put a dataset on object storage."""

from dataclasses import dataclass
from pathlib import Path

from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.parquet_files import changed, local_file
from tsas_cli.recordings.storage import Address
from tsas_cli.records.result import Result, Table, heading
from tsas_cli.stages.given import Named, place_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.wording import count_of


@dataclass(frozen=True, repr=False, eq=False)
class UploadResult(Result):
    """What was put where."""

    def tables(self) -> list[Table]:
        """Return each object and its size."""
        rows = [(name, f"{size / 1e6:.3f} MB") for name, size in self.summary["files"].items()]
        return [(self.summary["address"], ("object", "size"), rows)]


def upload(
    folder: Named, address: str, *, force: bool = False, step: Steps = NO_PROGRESS
) -> UploadResult:
    """Put a dataset on object storage: its recordings, and the manifest last.

    A recording that an interrupted call has put there is not sent again.

    Until then the checksums of an older manifest reveal that its recordings are being replaced.

    Parameters
    ----------
    folder
        A dataset's local folder.
    address
        Where to put it: `s3://BUCKET/PATH` or `gs://BUCKET/PATH`.
    force
        Replace a dataset that is there.
    step
        Called once for each run.

    Returns
    -------
    UploadResult
        `.summary["files"]` holds the size of each object [bytes].

    Raises
    ------
    InputError
        The dataset is wrong, one is there and `force` is not set, a recording would replace an
        object of no dataset, or the storage refuses.
    """
    source, target = place_of(folder), place_of(address)
    if not isinstance(source, Path):
        raise InputError("is no local folder", where=source, expected="a dataset's folder")
    if not isinstance(target, Address):
        raise InputError("is no address", where=target, expected="s3://… or gs://…")
    dataset, manifest = read_dataset(source), target / MANIFEST_FILE
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
        existing, size = target / run.file, local_file(source, run).stat().st_size
        # An object of this size may be of an interrupted upload.
        if run.file not in replaced and existing.is_file() and existing.size() != size:
            raise InputError(
                "was not written by `tsas upload`",
                where=existing,
                expected="an address that is free, or a dataset",
                remedy="choose another address, or remove the object with the storage's own tools",
            )
    files: dict[str, int] = {}
    try:
        for run in dataset.runs:
            path, copy = local_file(source, run), target / run.file
            digest = run.sha256.lower()
            if sha256_of(path) != digest:
                raise changed(path, run)
            if not copy.holds(digest):
                copy.copy_from(path, digest)
            files[run.file] = path.stat().st_size
            step()
        content = (source / MANIFEST_FILE).read_bytes()
        manifest.write_bytes(content)
    except InputError as error:
        there = f"{len(files)} of {count_of(len(dataset.runs), 'recording')} are there"
        error.remedy = "; ".join(filter(None, (error.remedy, there, "the next call goes on")))
        raise
    files[MANIFEST_FILE] = len(content)
    summary = heading("upload") | {"folder": str(source), "address": str(target), "files": files}
    return UploadResult(summary, None)
