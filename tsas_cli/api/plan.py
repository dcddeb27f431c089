"""Say what runs could show before anyone measures."""

from pathlib import Path

from tsas_cli.api.given import Named, path_of
from tsas_cli.diagnosis.plan_stage import PlanResult, plan_runs
from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.storage import place_of
from tsas_cli.steps import SILENT, Steps


def plan(
    runs: Dataset | Named,
    *,
    out: Named | None = None,
    force: bool = False,
    step: Steps = SILENT,
) -> PlanResult:
    """Say from which size on runs would show each effect, and which further run helps most.

    Parameters
    ----------
    runs
        A dataset, its folder, or a rig file with planned runs (docs/plan.md).
    out
        Where to write `plan.json`; None writes nothing.
    force
        Replace the folder if it is there.
    step
        Told of a piece of work for each run that might be added.

    Returns
    -------
    PlanResult
        `.plan` holds what is seen from which size on, and the proposals.

    Raises
    ------
    InputError
        The dataset or the file is wrong, no run shows anything, or `out` exists and `force` is
        not set.
    """
    if not isinstance(runs, Dataset):
        place = place_of(runs)
        planned = isinstance(place, Path) and not place.is_dir()
        runs = Path(runs) if planned else read_dataset(place)
    return plan_runs(runs, path_of(out), force=force, step=step)
