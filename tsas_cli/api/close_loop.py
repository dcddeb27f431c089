"""Say what a diagnosis is worth in tracking."""

from collections.abc import Sequence
from pathlib import Path

from tsas_cli.api.given import Named, at_least, listed, number_of_seeds, path_of
from tsas_cli.steps import SILENT, Steps
from tsas_cli.tracking.closing_stage import ClosingResult, chosen, close_all
from tsas_cli.tracking.settings import read_settings


def close_loop(
    *,
    out: Named,
    cases: str | Sequence[str] | None = None,
    hide: str | Sequence[str] = (),
    settings: Named | None = None,
    seeds: int = 5,
    first_seed: int = 1,
    force: bool = False,
    step: Steps = SILENT,
) -> ClosingResult:
    """Record, diagnose and track with the nominal, the extended and the true model side by side.

    Parameters
    ----------
    out
        Where to write `closing.json` and, for each case, its recordings and what the stages say
        of them; each stage reads what the one before has written.
    cases
        The names of the known cases that are taken; all without it.
    hide
        Changes `NAME=VALUE` of the plant to hide in place of the known cases.
    settings
        A file with rig, drive, sensors, reference and gains (docs/tracking.md).
    seeds
        How many seeds of noise.
    first_seed
        The first of them.
    force
        Replace the folder if it is there.
    step
        Told of seven pieces of work per case.

    Returns
    -------
    ClosingResult
        `.summary["cases"]` holds by case what was hidden, what was named, and the scores by
        controller and model (RMSE in N).

    Raises
    ------
    InputError
        A case or a setting is wrong, a loop is unstable, or `out` exists and `force` is not set.
    """
    wanted = chosen(None if cases is None else listed(cases), listed(hide))
    read, first = read_settings(path_of(settings)), at_least(0, first_seed, "first_seed")
    seeds_taken = range(first, first + number_of_seeds(seeds))
    return close_all(
        wanted, read, Path(out), seeds_taken, inputs=[path_of(settings)], force=force, step=step
    )
