"""Say whether files are still what was recorded of them."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass

from tsas_cli.records.result import Result, Table, heading
from tsas_cli.stages.given import Named, file_of, paths_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.verifying.verify import Verified, verify_all

STATES = ("fits", "changed", "missing", "cannot tell")


@dataclass(frozen=True, repr=False, eq=False)
class VerifyResult(Result):
    """What became of every file whose checksum is recorded, and of those that lack one.

    Each has a `state` (`fits`, `changed`, `missing`, `cannot tell`), who recorded its checksum
    (`by`), and `why` it does not fit.
    """

    files: tuple[Verified, ...]

    @property
    def wrong(self) -> list[Verified]:
        """The files that have changed or are missing."""
        return [one for one in self.files if one.state in {"changed", "missing"}]

    def tables(self) -> list[Table]:
        """Return a row for each file that does not fit, or cannot be checked."""
        odd = [one for one in self.files if one.state != "fits"]
        rows = [(one.state, one.file, one.why, one.by) for one in odd]
        counts = self.summary["counts"]
        recorded = sum(counts.values()) - counts["cannot tell"]
        title = f"{counts['fits']} of {recorded} recorded checksums fit"
        return [(title, ("state", "file", "why", "recorded in") if rows else (), rows)]


def verify(
    path: Named, *, raw: Named | Iterable[Named] = (), step: Steps = NO_PROGRESS
) -> VerifyResult:
    """Check every checksum from a page, or all that stages wrote, back to the raw recordings.

    Parameters
    ----------
    path
        A page of `tsas report`, the folder of a stage or of a dataset, or one that holds some.
    raw
        Folders where raw recordings are looked for that are not where they were ingested from.
    step
        Called once for each checksum.

    Returns
    -------
    VerifyResult
        `.files` says of each file what became of it, `.wrong` holds those that have changed or are
        missing.

    Raises
    ------
    InputError
        There is nothing that tsas has written, or no folder that `raw` names.
    """
    folders = paths_of(raw, least=0)
    for folder in folders:
        if not folder.is_dir():
            raise InputError("is no folder", where=folder, expected="one with raw recordings")
    files = verify_all(file_of(path), folders, step)
    found = Counter[str](one.state for one in files)
    summary = heading("verify") | {
        "path": str(path),
        "counts": {state: found[state] for state in STATES},
        "files": [asdict(one) for one in files],
    }
    return VerifyResult(summary, None, tuple(files))
