"""All controllers: their settings, their gains, and the kernel that calls the active one."""

from typing import NamedTuple

from pydantic import Field

from tsas_cli.controllers import CONTROLLERS
from tsas_cli.controllers.adaptive_sliding_mode import (
    AdaptiveSettings,
    AdaptiveSlidingMode,
    adaptive_sliding_mode,
)
from tsas_cli.controllers.disturbance_observer import (
    DisturbanceObserver,
    ObserverSettings,
    disturbance_observer,
)
from tsas_cli.controllers.pid import Pid, PidSettings, pid
from tsas_cli.controllers.signals import Signals
from tsas_cli.controllers.sliding_mode import (
    SlidingMode,
    SlidingSettings,
    distance,
    sliding_mode,
)
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats
from tsas_cli.support.strict_table import StrictTable

PID, SLIDING, ADAPTIVE, OBSERVER = range(len(CONTROLLERS))  # one for each, in their order
MEMORY = 3  # numbers that a controller keeps from sample to sample, at most


class ControlLaws(NamedTuple):
    """Every controller's gains, and which of them is active (`kind`)."""

    kind: int
    pid: Pid
    sliding_mode: SlidingMode
    adaptive_sliding_mode: AdaptiveSlidingMode
    disturbance_observer: DisturbanceObserver


class ControllerSettings(StrictTable):
    """Every controller's table in a settings file."""

    pid: PidSettings = Field(default_factory=PidSettings)
    sliding_mode: SlidingSettings = Field(default_factory=SlidingSettings, alias="sliding-mode")
    adaptive_sliding_mode: AdaptiveSettings = Field(
        default_factory=AdaptiveSettings, alias="adaptive-sliding-mode"
    )
    disturbance_observer: ObserverSettings = Field(
        default_factory=ObserverSettings, alias="disturbance-observer"
    )

    def laws(self, controller: str, gain_mm_per_s_rpm: float) -> ControlLaws:
        """Return the gains as the kernel takes them, one controller active."""
        return ControlLaws(
            CONTROLLERS.index(controller),
            self.pid.law(),
            self.sliding_mode.law(),
            self.adaptive_sliding_mode.law(),
            self.disturbance_observer.law(gain_mm_per_s_rpm),
        )

    def of(self, controller: str) -> PidSettings | SlidingSettings | ObserverSettings:
        """Return the table of one controller."""
        table: PidSettings | SlidingSettings | ObserverSettings
        table = getattr(self, controller.replace("-", "_"))
        return table

    def sliding_modes(self) -> dict[str, SlidingSettings]:
        """Return the two sliding modes by the names of their fields."""
        return {
            "sliding_mode": self.sliding_mode,
            "adaptive_sliding_mode": self.adaptive_sliding_mode,
        }


@kernel
def initial_memory(laws: ControlLaws, memory: Floats) -> None:
    """Write what the active controller begins with; the others begin with zeros."""
    if laws.kind == ADAPTIVE:
        start = laws.adaptive_sliding_mode.start
        memory[0], memory[1], memory[2] = start.phi1, start.phi2, start.phi3


@kernel
def control(
    signals: Signals, laws: ControlLaws, memory: Floats, step_s: float
) -> tuple[float, float]:
    """Return the motor speed on top of the feedforward [rpm], and s of a surface, else 0."""
    if laws.kind == PID:
        return pid(signals, laws.pid, memory, step_s), 0.0
    if laws.kind == SLIDING:
        sliding = laws.sliding_mode
        u = sliding_mode(signals, sliding.surface, sliding.phi)
        return u, distance(signals, sliding.surface)
    if laws.kind == ADAPTIVE:
        adaptive = laws.adaptive_sliding_mode
        u = adaptive_sliding_mode(signals, adaptive, memory, step_s)
        return u, distance(signals, adaptive.surface)
    if laws.kind == OBSERVER:
        return disturbance_observer(signals, laws.disturbance_observer, memory, step_s), 0.0
    raise ValueError("a controller without its call in controllers/laws.py")
