"""The drive has too few reversals.

Two full cycles have three reversals. With fewer, a run shows each phase at most once, so that its
repeatability is unknown.
"""

from collections.abc import Iterator

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

_ENOUGH = 3


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield a remark if the drive has fewer than three reversals."""
    reversals = max(len(trial.strokes) - 1, 0)
    if reversals >= _ENOUGH:
        return
    moves = f"has {count_of(reversals, 'reversal')}"
    yield Remark(
        "warning",
        f"x_in_mm {moves if trial.strokes else 'does not move visibly'}; two full cycles have "
        f"{_ENOUGH} reversals",
        "record at least two full cycles of contraction and loosening",
        "x_in_mm",
    )


CHECK = QualityCheck("few-reversals", find, needs=("x_in_mm",), of_long="decimated")
