"""What of a stage's folder is no longer as the stage wrote it, for those that read it."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_cli.support.replacing import SUMS
from tsas_cli.verifying.claims import claims_of


def change_notes(given: Iterable[object]) -> list[str]:
    """Return a sentence for each folder, of what is given, that was changed since it was written.

    Of a file in such a folder, that file counts alone; what is no path, or has no checksums beside
    it, tells nothing.
    """
    paths = dict.fromkeys(path for path in given if isinstance(path, Path))
    return [
        f"Changed since it was written: {', '.join(found)}. What is shown of it is not what the "
        "stage found; `tsas verify` says more."
        for path in paths
        if (found := list(_changed(path)))
    ]


def _changed(path: Path) -> Iterator[str]:
    folder = path if path.is_dir() else path.parent
    try:
        claims = list(claims_of(folder / SUMS)) if (folder / SUMS).is_file() else []
    except InputError:
        yield f"{folder.name}/{SUMS}"
        return
    for claim in claims:
        if path in (folder, folder / claim.file) and not _fits(folder / claim.file, claim.sha256):
            yield f"{folder.name}/{claim.file}"


def _fits(path: Path, sha256: str) -> bool:
    try:
        return sha256_of(path) == sha256
    except OSError:
        return False
