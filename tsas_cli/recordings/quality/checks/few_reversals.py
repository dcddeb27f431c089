"""The drive turns back too few times.

Two full cycles have three turning points between them. With fewer, a run shows each phase at most
once, and nothing says whether it repeats.
"""

from collections.abc import Iterator

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial
from tsas_cli.support.wording import count_of

_ENOUGH = 3


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Count the strokes of the drive."""
    turns = max(len(trial.strokes) - 1, 0)
    if turns >= _ENOUGH:
        return
    moves = f"turns back {count_of(turns, 'time')}"
    yield Remark(
        "warning",
        f"x_in_mm {moves if trial.strokes else 'does not move visibly'}; two full cycles have "
        f"{_ENOUGH} turning points",
        "record at least two full cycles of pulling and giving way",
        "x_in_mm",
    )


CHECK = Check("few-reversals", find, needs=("x_in_mm",))
