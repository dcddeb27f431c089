"""A run holds samples of another run of the dataset, which are no further evidence.

Two runs that repeat a motion have independent noise; a copy shares it. Each run is searched for in
every other one: the same samples, written again or at shifted times, a part of them, every second
or third of them, or samples interpolated linearly or by a cubic spline. Every channel that changes
has to agree to within a twentieth of its noise, for longer than a repeat of the motion could;
constant stretches are no evidence. Runs computed without noise agree wherever their motion does,
and are reported as copies. A filtered (averaged, decimated through a filter) or scaled copy is not
found. Fits count each sample once, and report it.
"""

from collections.abc import Iterator

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.search import find_copies
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark


def find(dataset: Dataset) -> Iterator[Remark | CannotTell]:
    """Yield the runs that hold samples of others; an error where their conditions differ."""
    found = find_copies(dataset, strict=False)
    for copy in found.copies:
        yield Remark(
            "error" if copy.contradicts else "warning",
            f"{copy.sentence}{copy.contradiction}",
            "correct the conditions in dataset.toml, or leave out the wrong run"
            if copy.contradicts
            else "remove the copy, or leave it as it is: fits count each sample once",
            first_s=copy.span.begin_s,
            run=copy.run.id,
        )
    for run in found.unordered:
        yield CannotTell("time does not increase", run)
    for run in found.short:
        yield CannotTell("too few rows change", run)


CHECK = QualityCheck("copies", find)
