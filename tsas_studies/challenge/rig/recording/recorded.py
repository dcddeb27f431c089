"""The runs of a case as they were recorded, and how a fault changes some channels of some runs."""

from collections.abc import Callable, Mapping

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recordings import Run

STEPS = {"x_in_mm": 0.002, "x_out_mm": 0.002, "f_in_N": 0.01, "f_out_N": 0.01}
CHANNELS = tuple(STEPS)
FORCES = ("f_in_N", "f_out_N")
Runs = Mapping[str, Run]


def changed(
    runs: Runs,
    channels: tuple[str, ...],
    change: Callable[[Floats, Floats], Floats],
    run: str | None = None,
) -> Runs:
    """Return the runs with `change(time_s, values)` in the place of each of these channels.

    In one run alone where it is named, else in all.
    """
    return {
        name: old.having(**{c: change(old.time_s, old.columns[c]) for c in channels})
        if run in (None, name)
        else old
        for name, old in runs.items()
    }
