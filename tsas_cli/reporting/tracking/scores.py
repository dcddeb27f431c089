"""The scores of every controller under every condition, with their spread over the seeds."""

from tsas_cli.records.tracking import Spread, TrackingFile
from tsas_cli.reporting.content import Table
from tsas_cli.reporting.numbers import ABSENT, with_spread

_COLUMNS = (
    ("RMSE [N]", "rmse_N"),
    ("lowest [N]", "lowest_error_N"),
    ("highest [N]", "highest_error_N"),
    ("outside 2 % [%]", "outside_percent"),
    ("effort [rpm]", "effort_rpm"),
    ("chatter [rpm/s]", "chatter_rpm_per_s"),
)


def table(tracking: TrackingFile) -> Table:
    """Return the table, with its spread where there is more than one seed."""
    seeds = tracking.seeds[1] - tracking.seeds[0] + 1
    over = f", mean ± standard deviation over {seeds} seeds of noise" if seeds > 1 else ""
    rows = tuple(
        (
            result.controller,
            result.condition,
            *(_cell(getattr(result.scores, key)) for _, key in _COLUMNS),
            _limit(result.scores.at_limit_percent),
        )
        for result in tracking.results
    )
    header = ("controller", "condition", *(title for title, _ in _COLUMNS), "at its limit [%]")
    numeric = frozenset(range(2, len(header)))
    return Table(f"Scores{over}", header, rows, numeric=numeric).without_empty()


def _cell(number: Spread) -> str:
    return with_spread(number.mean, number.sd)


def _limit(number: Spread) -> str:
    """Return how long the motor is at its speed limit; nothing where it never is."""
    return _cell(number) if number.mean else ABSENT
