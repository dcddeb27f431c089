"""Rows arrive in batches, and their times are those of the arrival.

A computer reads a buffer of the data acquisition every few samples and stamps the rows then: times
are near together, or equal, and jump between batches. The channels move on evenly from row to row,
which tells batches from gaps. Wrong times are a wrong phase of every motion; the finding says how
much that is beside the noise.
"""

from collections.abc import Iterator

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the batches of the time stamps, and what they cost the channel that suffers most."""
    batches = trial.batches
    if batches is None:
        return
    costs = {
        name: batches.cost(values, trial.sizes[name].noise)
        for name, values in trial.mechanical.items()
    }
    worst = max(costs, key=lambda name: costs[name], default=None)
    cost = "" if worst is None else f"; the wrong times change {worst} by {costs[worst]:.2g}"
    yield Remark(
        "error",
        f"rows come in batches of {batches.rows}: their times are {1e3 * batches.within_s:.3g} ms "
        f"apart, then {1e3 * batches.between_s:.4g} ms"
        + (f"{cost} × its noise level (RMS)" if cost else ""),
        "if no sample is lost, let the rows count at ingest: time_s = { rate_Hz = "
        f"{1.0 / batches.row_s:.5g} }} in the map; record with the clock of the data acquisition",
        "time_s",
    )


CHECK = QualityCheck("time-batches", find)
