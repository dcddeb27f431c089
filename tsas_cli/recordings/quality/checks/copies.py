"""A run holds samples of another run of the dataset, which are no further evidence.

Two runs that repeat a motion have noise of their own; a copy shares it. So each run is looked for
in every other one: the same samples, written again or at shifted times, a piece of them, every
second or third of them, or what was laid between them on straight lines or on a cubic spline. Every
channel that changes has to agree to within a twentieth of its noise, for so long that no repeat
would; where nothing changes nothing is shown. Runs computed without noise agree wherever their
motion does, and are called copies. A copy that was filtered (averaged, decimated through a filter)
or scaled is not found. What is fitted counts each sample once, and says so.
"""

from collections.abc import Iterator

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.search import find_copies
from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark


def find(dataset: Dataset) -> Iterator[Remark | CannotTell]:
    """Say which runs hold samples of which others; an error where their conditions differ."""
    found = find_copies(dataset, strict=False)
    for copy in found.copies:
        yield Remark(
            "error" if copy.contradicts else "warning",
            f"{copy.sentence}{copy.contradiction}",
            "correct the conditions in dataset.toml, or leave out what is not so"
            if copy.contradicts
            else "remove the copy, or leave it as it is: fits count each sample once",
            first_s=copy.span.begin_s,
            run=copy.run.id,
        )
    for run in found.unordered:
        yield CannotTell("time does not increase", run)
    for run in found.short:
        yield CannotTell("too few rows change", run)


CHECK = Check("copies", find)
