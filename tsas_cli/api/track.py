"""Follow a wanted force on a simulated rig."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import pyarrow as pa

from tsas_cli.api.given import Named, at_least, listed, number_of_seeds, one_of, path_of
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.errors import InputError
from tsas_cli.identification.drive_file import IdentifiedDrive
from tsas_cli.identification.model import Model
from tsas_cli.steps import SILENT, Steps
from tsas_cli.tracking.conditions import Condition, disturbed, proximal_spring
from tsas_cli.tracking.track import TendonDynamics
from tsas_cli.tracking.track_stage import Call, TrackingResult, track_all

DYNAMICS: tuple[TendonDynamics, ...] = ("slip", "lugre")
COMPARED_SEEDS = 10


def track(
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    plant: Model | Named | None = None,
    drive: IdentifiedDrive | Named | None = None,
    controllers: str | Sequence[str] = "adaptive-sliding-mode",
    compare: bool = False,
    reference: Named = "sine",
    disturb: str | Sequence[str] = (),
    as_printed: bool = False,
    dynamics: Literal["slip", "lugre"] = "slip",
    settings: Mapping[str, Any] | Named | None = None,
    seeds: int | None = None,
    first_seed: int = 1,
    force: bool = False,
    step: Steps = SILENT,
    each: Callable[[dict[str, Any], str, pa.Table], None] = lambda *_: None,
) -> TrackingResult:
    """Follow a wanted force with a controller that sees x_in alone.

    Parameters
    ----------
    out
        Where to write the runs as a dataset, and `tracking.json`; None writes nothing.
    model
        What the controller knows of the rig, or its file; the paper's rig without it.
    plant
        What the controller acts on, or its file; the same as `model` without it.
    drive
        What the controller knows of the drive, or its file; kinematics without it.
    controllers
        One or several of `pid`, `sliding-mode`, `adaptive-sliding-mode`, `disturbance-observer`,
        or `all`.
    compare
        All controllers, with and without a disturbance, over 10 seeds.
    reference
        `sine`, `two-frequency`, `steps`, `ramps`, or a Parquet file with `f_out_ref_N`.
    disturb
        Changes of the plant, `NAME=VALUE`, from S seconds on with `NAME=VALUE@S`.
    as_printed
        ks of the sliding modes per mm as the paper prints it, which makes a relay.
    dynamics
        The plant's tendon. `slip`: quasi-static; `lugre`: dynamic.
    settings
        A file with rig, drive, sensors, reference and gains, or its content (docs/tracking.md).
    seeds
        How many seeds of noise; 1 without it, 10 with `compare`.
    first_seed
        The first of them.
    force
        Replace the folder if it is there.
    step
        Told of a piece of work per run.
    each
        Called for each recording with the summary so far, its name and its table.

    Returns
    -------
    TrackingResult
        `result["pid-undisturbed"].columns` holds the run of the first seed, arrays of shape (m,):
        `time_s`, `f_out_ref_N` (wanted), `f_out_true_N`, `x_in_mm`, `motor_speed_rpm`, …;
        `.summary["results"]` holds the scores, in N and rpm.

    Raises
    ------
    InputError
        A file is wrong, a controller unknown, the reference out of reach, the loop unstable, or
        `out` exists and `force` is not set.
    """
    named = tuple(listed(controllers))
    if not named:
        raise InputError("no controller is named", expected=f"some of {', '.join(CONTROLLERS)}")
    conditions = [disturbed(listed(disturb))] if disturb else []
    if compare:
        conditions = [Condition("undisturbed"), *(conditions or [proximal_spring()])]
    call = Call(
        model=path_of(model),
        plant=path_of(plant),
        drive=path_of(drive),
        settings=path_of(settings),
        controllers=CONTROLLERS if compare or named == ("all",) else tuple(dict.fromkeys(named)),
        conditions=tuple(conditions) or (Condition("undisturbed"),),
        reference=str(reference),
        as_printed=as_printed,
        dynamics=one_of(DYNAMICS, dynamics, "dynamics"),
        seeds=(COMPARED_SEEDS if compare else 1) if seeds is None else number_of_seeds(seeds),
        first_seed=at_least(0, first_seed, "first_seed"),
    )
    return track_all(call, path_of(out), force=force, step=step, each=each)
