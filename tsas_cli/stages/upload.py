"""Put a dataset on object storage."""

from dataclasses import dataclass
from pathlib import Path

from tsas_cli.recordings.storage import Address, location_of
from tsas_cli.recordings.upload import upload_dataset
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps


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
    """Put a dataset on object storage.

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
        The dataset is wrong, one is there and `force` is not set, or the storage refuses.
    """
    source, target = location_of(folder), location_of(address)
    if not isinstance(source, Path):
        raise InputError("is no local folder", where=source, expected="a dataset's folder")
    if not isinstance(target, Address):
        raise InputError("is no address", where=target, expected="s3://… or gs://…")
    files = upload_dataset(source, target, force=force, step=step)
    summary = {
        "format": 1,
        "stage": "upload",
        "version": __version__,
        "folder": str(source),
        "address": str(target),
        "files": files,
    }
    return UploadResult(summary, None)
