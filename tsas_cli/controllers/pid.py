"""PID: feedback of the error of x_in, its integral and its rate.

Law: u = KP e + KI ∫e dt + KD de/dt, e = x_inv − x_in. The integral is frozen while the motor is at
its limit (anti-windup). With the gains of Yang 2025 ("Comparative verification", e in mm, u in rpm)
the bandwidth is KP K = 0.6 rad/s: the error after a reversal, while the motor winds up the gear,
decays over seconds.
When it fails: disturbances faster than the loop; a rate taken from a noisy x_in.
"""

from typing import ClassVar, NamedTuple

from tsas_cli.controllers.signals import Signals
from tsas_cli.numerics.compiled import kernel
from tsas_cli.paper.settings import printed
from tsas_cli.support.arrays import Floats
from tsas_cli.support.plausible import Gain
from tsas_cli.support.strict_table import StrictTable

SUM = 0  # of the memory: ∫e dt [mm s]


class Pid(NamedTuple):
    """Gains from mm, mm s and mm/s to rpm."""

    proportional_rpm_per_mm: float = 25.0
    integral_rpm_per_mm_s: float = 65.0
    derivative_rpm_s_per_mm: float = 1.0


class PidSettings(StrictTable):
    """Gains of the paper; e in mm, u in rpm."""

    COLUMNS: ClassVar = ("error_sum_mm_s",)  # of the recording: what the memory holds
    proportional_rpm_per_mm: Gain = printed("controllers.pid.proportional")
    integral_rpm_per_mm_s: Gain = printed("controllers.pid.integral")
    derivative_rpm_s_per_mm: Gain = printed("controllers.pid.derivative")

    def law(self) -> Pid:
        """Return the gains as the kernel takes them."""
        return Pid(**self.model_dump())


@kernel
def pid(signals: Signals, gains: Pid, memory: Floats, step_s: float) -> float:
    """Return the motor speed [rpm] on top of the feedforward."""
    if not signals.limited:
        memory[SUM] += signals.e * step_s
    u: float = (
        gains.proportional_rpm_per_mm * signals.e
        + gains.integral_rpm_per_mm_s * memory[SUM]
        + gains.derivative_rpm_s_per_mm * signals.de
    )
    return u
