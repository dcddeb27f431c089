"""The paper's closed loops: its rig, drive, reference and gains, with and without disturbance.

In whose units ks of the sliding modes is, the paper does not print. Both readings are followed:
per mm as the bounds of Table 4 suggest, where the sampled loop is a relay, and per m, where it is
none. Nothing else is chosen here; rate, sensor, motor limit and filter are `tsas track`'s.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np

from tsas_cli.controllers.path import DrivePath
from tsas_cli.numerics.side_by_side import each
from tsas_cli.support.arrays import Floats
from tsas_cli.tracking.conditions import Condition, proximal_spring
from tsas_cli.tracking.recorded import stated_rig
from tsas_cli.tracking.references import reference
from tsas_cli.tracking.settings import Settings, printed_gains
from tsas_cli.tracking.track import Known, Plant, Score, Tracked, plan, run_loop

Reading = Literal["per mm", "per m"]
READINGS: tuple[Reading, ...] = ("per mm", "per m")
SEEDS = range(1, 11)
SLIDING = ("sliding-mode", "adaptive-sliding-mode")
NAMES = {"pid": "PID", "sliding-mode": "SMC", "adaptive-sliding-mode": "ASMC"}
CONDITIONS = {"undisturbed": Condition("undisturbed"), "disturbed": proximal_spring()}


def settings_for(reading: Reading) -> Settings:
    """Return the settings with ks read per mm or per m."""
    return printed_gains(Settings()) if reading == "per mm" else Settings()


def paper_plant(settings: Settings, condition: str) -> tuple[Known, Plant]:
    """Return what the controllers know, the paper's models, and the plant."""
    rig = stated_rig(settings)
    plant = Plant(rig, settings.drive.actuator())
    return Known(rig, settings.drive.kinematic()), CONDITIONS[condition].of(plant)


@cache
def planned(shape: str) -> tuple[Floats, DrivePath]:
    """Return the wanted force and the path of a reference by the paper's model."""
    settings = Settings()
    wanted = reference(shape, settings.reference, settings.step_s)
    return wanted, plan(wanted, paper_plant(settings, "undisturbed")[0], settings)


@dataclass(frozen=True)
class Followed:
    """The scores of a controller over all seeds, and the run of the first one."""

    scores: tuple[Score, ...]
    run: Tracked

    def mean(self, number: str) -> float:
        """Return the mean of one number of the scores."""
        return float(np.mean([getattr(score, number) for score in self.scores]))

    def spread(self, number: str) -> float:
        """Return the standard deviation of one number of the scores."""
        return float(np.std([getattr(score, number) for score in self.scores], ddof=1))


def followed(
    controller: str,
    condition: str,
    reading: Reading,
    shape: str = "sine",
    *,
    friction: float = 1.0,
    phi2: float | None = None,
) -> Followed:
    """Follow a reference with a controller over all seeds.

    The plant has `friction` times what the controller knows; `phi2` replaces that of the sliding
    modes.
    """
    read: Reading = reading if controller in SLIDING else "per m"  # no other law has a ks
    return _followed(controller, condition, read, shape, friction, phi2)


@cache
def _followed(
    controller: str,
    condition: str,
    reading: Reading,
    shape: str,
    friction: float,
    phi2: float | None,
) -> Followed:
    settings = settings_for(reading)
    if phi2 is not None:
        gains = settings.controllers
        changed = {
            name: law.model_copy(update={"phi": (law.phi[0], phi2, law.phi[2])})
            for name, law in gains.sliding_modes().items()
        }
        controllers = gains.model_copy(update=changed)
        settings = settings.model_copy(update={"controllers": controllers})
    known, plant = paper_plant(settings, condition)
    mu = plant.rig.friction_coefficient * friction
    plant = replace(plant, rig=plant.rig._replace(friction_coefficient=mu))
    wanted, path = planned(shape)

    def run(seed: int) -> Tracked:
        return run_loop(wanted, path, known, plant, controller, settings, seed=seed, relay=True)

    first = run(SEEDS[0])
    others = each(lambda seed: run(seed).score, SEEDS[1:])
    return Followed((first.score, *others), first)
