"""Disturbance observer: estimates the drive's speed error as a disturbance and compensates it.

The drive is modelled as dx/dt = K (u + d): an integrator, and all else a disturbance d in rpm. A
Luenberger observer with both poles at ω_o estimates error and disturbance from the commanded speed
and the measured x_in; then u = ω_c ê/K − d̂. It is the linear active disturbance rejection of Gao
2003 (Proc. American Control Conference, 4989–4996) for a plant of first order, ω_o = 4 ω_c by
default. The reference speed is the feedforward.
When it fails: ω_o near the resonance of gear and turntable (88 Hz for the drive of Yang 2025), or
above a third of the sampling rate.
"""

from typing import ClassVar, NamedTuple

from tsas_cli.controllers.signals import Signals
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats
from tsas_cli.support.plausible import AngularFrequency
from tsas_cli.support.strict_table import StrictTable

ERROR, DISTURBANCE = 0, 1  # of the memory


class DisturbanceObserver(NamedTuple):
    """Bandwidths of loop and observer, and the drive's gain."""

    loop_rad_per_s: float
    observer_rad_per_s: float
    gain_mm_per_s_rpm: float


class ObserverSettings(StrictTable):
    """Bandwidths of loop and observer."""

    COLUMNS: ClassVar = ("error_estimate_mm", "disturbance_rpm")
    loop_rad_per_s: AngularFrequency = 10.0
    observer_rad_per_s: AngularFrequency = 40.0

    def law(self, gain_mm_per_s_rpm: float) -> DisturbanceObserver:
        """Return the gains as the kernel takes them; the drive's gain is that of its model."""
        return DisturbanceObserver(self.loop_rad_per_s, self.observer_rad_per_s, gain_mm_per_s_rpm)


@kernel
def disturbance_observer(
    signals: Signals, law: DisturbanceObserver, memory: Floats, step_s: float
) -> float:
    """Return the motor speed [rpm] on top of the feedforward.

    The inputs of the observer's error are the disturbance and the speed applied on top of the
    feedforward; explicit Euler, first order, once a sample.
    """
    w, K = law.observer_rad_per_s, law.gain_mm_per_s_rpm
    innovation = signals.e - memory[ERROR]
    rate = -K * (signals.applied + memory[DISTURBANCE])
    memory[ERROR] += step_s * (rate + 2.0 * w * innovation)
    memory[DISTURBANCE] -= step_s * w * w * innovation / K
    u: float = law.loop_rad_per_s * memory[ERROR] / K - memory[DISTURBANCE]
    return u
