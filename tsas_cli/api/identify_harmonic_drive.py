"""Identify the drive from the motor's speed to x_in."""

from collections.abc import Iterable
from typing import Literal

from tsas_cli.api.given import Named, dataset_of, one_of, path_of
from tsas_cli.diagnosis.drive_stage import DriveResult, identify_drive
from tsas_cli.numerics.linear_response import Hold
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.steps import SILENT, Steps

SPEEDS: tuple[Literal["measured", "commanded"], ...] = ("measured", "commanded")
HOLDS: dict[str, Hold] = {"measured": "first", "commanded": "zero"}


def identify_harmonic_drive(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    speed: Literal["measured", "commanded"] = "measured",
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = SILENT,
) -> DriveResult:
    """Fit the drive from motor speed [rpm] to x_in [mm], diagnose it, and give its feedforward.

    Parameters
    ----------
    dataset
        A dataset, or its folder, with `motor_speed_rpm` and `x_in_mm`.
    out
        Where to write `drive.toml`, `drive.json` and `runs/ID.parquet`; None writes nothing.
    speed
        What `motor_speed_rpm` holds. `measured`: linear between samples; `commanded`: kept until
        the next one.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Told of every structure; how many lie ahead grows with what is found.

    Returns
    -------
    DriveResult
        `.estimates` by name, with units and 95 % intervals; `.drive` for `track`; `.diagnosis`;
        `result["chirp"].columns` holds the simulated `x_in_mm` and `x_in_nominal_mm`, shape (n,).

    Raises
    ------
    InputError
        A recording does not serve, or `out` exists and `force` is not set.
    """
    hold = HOLDS[one_of(SPEEDS, speed, "speed")]
    return identify_drive(dataset_of(dataset, runs), path_of(out), hold, force=force, step=step)
