"""One run of the closed loop: the model of the controller makes the path, the plant follows it."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.controllers.closed_loop import (
    ASKED,
    F_OUT,
    GIVEN_UP,
    X_IN,
    DriveSensor,
    LoopPlant,
    LoopReference,
    close_loop,
    plant_at_rest,
)
from tsas_cli.controllers.path import DrivePath, follow
from tsas_cli.controllers.signals import error_filter
from tsas_cli.physics.ends import last_direction
from tsas_cli.physics.plant.laws import plant_laws
from tsas_cli.physics.plant.lugre_plant import empty_lumps
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.columns import largest
from tsas_cli.records.tracking import Scores, Spread
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError
from tsas_cli.support.wording import listed
from tsas_cli.tracking.settings import Settings

OUTSIDE = 0.02  # of the wanted force's range
TendonDynamics = Literal["slip", "lugre"]
RELAY_S = 0.5  # in which …
RELAY_SHARE = 0.25  # … a loop whose motor is at its limits for so much of the time, and …
RELAY_TURNS_PER_S = 20.0  # … goes so often from one to the other, is a relay
REMEDIES: dict[TendonDynamics, str] = {
    "slip": "use more substeps in [loop] of the settings",
    "lugre": "leave out [bristles.damping_N_s_per_mm], which is critical then, or use more "
    "substeps in [loop] of the settings",
}


@dataclass(frozen=True)
class Score:
    """One run. Errors are wanted less true force at the load; u is the speed asked for."""

    rmse_N: float
    lowest_error_N: float
    highest_error_N: float
    effort_rpm: float  # root mean square of u
    chatter_rpm_per_s: float  # total variation of u per second
    outside_percent: float  # time with an error beyond 2 % of the wanted force's range
    at_limit_percent: float  # time with the motor at its speed limit


@dataclass(frozen=True)
class Known:
    """What the controller knows: its model of the rig and of the drive.

    A drive whose stiffness is infinite is the paper's, Eq. (51): the feedforward is kinematics.
    """

    rig: Rig
    actuator: Actuator


@dataclass(frozen=True)
class Plant:
    """What the controller acts on; from `change_s` on the rig is `later`."""

    rig: Rig
    actuator: Actuator
    later: Rig | None = None
    change_s: float = 0.0


@dataclass(frozen=True)
class Tracked:
    """One run: the columns of `closed_loop` by name, shape (m,) each, and how well it followed."""

    time_s: Floats
    wanted_N: Floats
    columns: Floats
    score: Score
    unsettled: int
    is_relay: bool


def plan(wanted_N: Floats, known: Known, settings: Settings) -> DrivePath:
    """Return the path of the drive by the controller's model; see `controllers.path.follow`.

    InputError: it goes farther than a recording may.
    """
    path = follow(
        wanted_N,
        settings.step_s,
        known.rig,
        known.actuator,
        crossing_s=settings.loop.crossing_s,
        nodes=settings.loop.nodes,
    )
    farthest, most = float(np.abs(path.drive[0]).max()), largest("x_in_mm")
    if farthest > most:
        raise InputError(
            f"x_in_mm goes to {farthest:.4g} mm",
            where="the path of the drive",
            expected=f"at most {most:g} mm, as in every recording",
            remedy="check the wanted force, friction and stiffness of the rig",
        )
    return path


def feedforward(path: DrivePath, actuator: Actuator) -> Floats:
    """Return kV dx/dt + kA d²x/dt² of the motor's path, shape (m,) [rpm], Eq. (51)."""
    speed, acceleration = path.motor[1], path.motor[2]
    rpm: Floats = (speed + actuator.motor_lag_s * acceleration) / actuator.gain_mm_per_s_rpm
    return rpm


def run_loop(
    wanted_N: Floats,
    path: DrivePath,
    known: Known,
    plant: Plant,
    controller: str,
    settings: Settings,
    *,
    seed: int,
    dynamics: TendonDynamics = "slip",
    relay: bool = False,
) -> Tracked:
    """Run the loop once, from rest at the path's first place.

    `dynamics` is the plant's; the controller's model is quasi-static.

    InputError: the loop is unstable: x_in has run away, or the motor swings from limit to limit
    (`relay` follows that nevertheless). The plant changes after the run's end. Or the tendon cannot
    be followed.
    """
    step_s, m = settings.step_s, wanted_N.size
    change_at = round(plant.change_s / step_s) if plant.later else -1
    if change_at >= m:
        raise InputError(
            f"the plant changes at {plant.change_s:g} s",
            expected=f"a time within the reference's {(m - 1) * step_s:g} s",
        )
    rng = np.random.default_rng(seed)
    noise = settings.sensor.noise_mm * rng.standard_normal(m)
    A, b = error_filter(settings.loop.filter_Hz, step_s)
    limit_rpm = plant.actuator.speed_limit_rpm
    nodes = settings.loop.nodes
    columns, unsettled, done = close_loop(
        LoopReference(
            np.ascontiguousarray(path.drive[:, :m]), feedforward(path, known.actuator)[:m]
        ),
        DriveSensor(step_s, noise, settings.sensor.step_mm, A, b),
        settings.controllers.laws(controller, known.actuator.gain_mm_per_s_rpm),
        LoopPlant(
            actuator=plant.actuator,
            rigs=(plant.rig, plant.later or plant.rig),
            laws=(plant_laws(plant.rig), plant_laws(plant.later or plant.rig)),
            change_at=change_at,
            substeps=settings.loop.substeps,
            nodes=nodes,
            start=plant_at_rest(float(path.drive[0, 0]), plant.rig, plant.actuator, nodes),
        ),
        empty_lumps() if dynamics == "lugre" else None,
    )
    time_s: Floats = np.arange(m, dtype=np.float64) * step_s
    if unsettled > GIVEN_UP * m * settings.loop.substeps:
        raise InputError(
            f"the tendon cannot be followed: {unsettled} steps do not settle until "
            f"{done * step_s:.4g} s",
            where=f"plant, --dynamics {dynamics}",
            remedy=REMEDIES[dynamics],
        )
    if done < m:
        raise InputError(
            f"the loop is unstable: x_in is {columns[X_IN, done - 1]:.4g} mm at "
            f"{time_s[done]:.4g} s, where {path.drive[0, done]:.4g} mm is wanted",
            where=f"controller {controller}",
            remedy=_steadier(settings),
        )
    asked = columns[ASKED]
    swings = _swings(asked, limit_rpm, step_s)
    if swings is not None and not relay:
        k, often = swings
        raise InputError(
            f"the loop is unstable: from {time_s[k]:.4g} s on the motor swings between its limits "
            f"of ±{limit_rpm:g} rpm, {often:.0f} times a second; x_in is {columns[X_IN, k]:.4g}, "
            f"wanted {path.drive[0, k]:.4g} mm",
            where=f"controller {controller}",
            remedy=_steadier(settings),
        )
    return Tracked(
        time_s,
        wanted_N,
        columns,
        score(wanted_N, columns[F_OUT], asked, step_s, limit_rpm),
        unsettled,
        swings is not None,
    )


def _steadier(settings: Settings) -> str:
    """Return what may end an instability: first the settings that are not the paper's rig."""
    usual = Settings()
    own = [t for t in ("rig", "drive", "sensor") if getattr(settings, t) != getattr(usual, t)]
    checked = f"check {listed(own)} in the settings, then " if own else ""
    return f"{checked}lower its gains or the filter's cutoff"


def _swings(asked: Floats, limit_rpm: float, step_s: float) -> tuple[int, float] | None:
    """Return the sample from which the motor swings between limits, and how often a second.

    A stable loop can keep the motor at one limit for long, but not throw it from one to the other.
    """
    side = np.where(np.abs(asked) >= limit_rpm, np.sign(asked), 0.0)
    last = last_direction(np.cumsum(side))  # the limit it was at last
    width = max(int(RELAY_S / step_s), 1)
    at_limit = _within(side != 0.0, width)
    turns = _within(np.append(last[1:] * last[:-1] < 0.0, False), width)
    found = np.flatnonzero((at_limit > RELAY_SHARE * width) & (turns > RELAY_TURNS_PER_S * RELAY_S))
    return (int(found[0]), float(turns[found[0]]) / RELAY_S) if found.size else None


def _within(true: Mask, width: int) -> npt.NDArray[np.int64]:
    """Return how many are true of each `width` in a row; of a shorter array, of all."""
    total = np.concatenate(([0], np.cumsum(true)))
    width = min(width, true.size)
    return total[width:] - total[:-width]


def score(
    wanted_N: Floats, f_out_N: Floats, asked_rpm: Floats, step_s: float, limit_rpm: float
) -> Score:
    """Return the numbers of a run, all arrays of shape (m,)."""
    error = wanted_N - f_out_N
    beyond = np.abs(error) > OUTSIDE * np.ptp(wanted_N)
    return Score(
        rmse_N=float(np.sqrt(np.mean(error**2))),
        lowest_error_N=float(error.min()),
        highest_error_N=float(error.max()),
        effort_rpm=float(np.sqrt(np.mean(asked_rpm**2))),
        chatter_rpm_per_s=float(np.abs(np.diff(asked_rpm)).sum() / (step_s * error.size)),
        outside_percent=100.0 * float(beyond.mean()),
        at_limit_percent=100.0 * float((np.abs(asked_rpm) >= limit_rpm).mean()),
    )


def over_seeds(scores: Sequence[Score]) -> Scores:
    """Return mean and standard deviation of each number over the seeds; of one seed no spread."""
    spreads = {}
    for field in fields(Score):
        values = np.array([getattr(one, field.name) for one in scores])
        spread = float(values.std(ddof=1)) if values.size > 1 else None
        spreads[field.name] = Spread(mean=float(values.mean()), sd=spread)
    return Scores(**spreads)
