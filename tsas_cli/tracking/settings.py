"""What a closed loop is made of beside model and drive; without a file it is the paper's rig.

Lengths, bend, preload and reference are those of Yang 2025 ("Verification of the proposed
controller"). What the paper does not give (rate, sensor, motor limit, filter, crossing) is chosen
here and said.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from tsas_cli.controllers.laws import ControllerSettings
from tsas_cli.controllers.sliding_mode import MM_PER_M
from tsas_cli.drive.file import IdentifiedDrive, checked_drive, read_drive
from tsas_cli.paper.settings import printed
from tsas_cli.physics.closed_form.capstan import speed_per_stiffness
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.recordings.manifest import read_toml
from tsas_cli.recordings.validation import parse
from tsas_cli.support.plausible import (
    AngularFrequency,
    Bend,
    Damping,
    Diameter,
    Duration,
    Friction,
    GearRatio,
    Inertia,
    Length,
    Modulus,
    MotorSpeed,
    NoiseMm,
    NoiseN,
    Radius,
    Stiffness,
    Tension,
    plausible,
)
from tsas_cli.support.strict_table import StrictTable

LONGEST_S = 3600.0  # of a wanted force


class RigSettings(StrictTable):
    """The rig: its conditions, and what a model would say where none is given."""

    tendon_diameter_mm: Diameter = printed("rig.tendon_diameter")
    tendon_modulus_GPa: Modulus = printed("rig.tendon_modulus")
    friction_coefficient: Friction = printed("rig.friction_coefficient")
    load_stiffness_N_per_mm: Stiffness = printed("rig.load_stiffness")
    sheath_length_mm: Length = printed("rig.sheath_length")
    total_bend_rad: Bend = printed("groups.a.total_bend")
    preload_N: Tension = printed("rig.preload")


class DriveSettings(StrictTable):
    """The plant's drive: the stiffness is km as chosen for kr, Eq. (34); the lag is ours."""

    turntable_radius_mm: Radius = printed("rig.turntable_radius")
    gear_ratio: GearRatio = printed("rig.gear_ratio")
    inertia_N_mm_s2: Inertia = printed("rig.inertia")
    damping_N_s_per_mm: Damping = printed("rig.drive_damping")
    drive_stiffness_N_per_mm: Stiffness = printed("stiffness.chosen.km")
    motor_lag_s: Duration = 0.002
    speed_limit_rpm: MotorSpeed = 3000.0

    def actuator(self) -> Actuator:
        """Return the drive as the plant takes it."""
        radius = self.turntable_radius_mm
        return Actuator(
            speed_per_stiffness(radius, self.gear_ratio),
            self.drive_stiffness_N_per_mm,
            self.inertia_N_mm_s2 / radius**2,
            self.damping_N_s_per_mm,
            self.motor_lag_s,
            self.speed_limit_rpm,
        )

    def kinematic(self) -> Actuator:
        """Return the drive as Eq. (51) knows it: radius and gear ratio, stiff, without lag."""
        return self.actuator()._replace(stiffness_N_per_mm=math.inf, motor_lag_s=0.0)


class ReferenceSettings(StrictTable):
    """The wanted force mean − amplitude · cos(ω t), or what other shapes make of it."""

    mean_N: Tension = printed("reference.mean")
    amplitude_N: Tension = printed("reference.amplitude")
    angular_frequency_rad_per_s: AngularFrequency = printed("reference.second_angular_frequency")
    duration_s: Annotated[float, plausible(1e-3, LONGEST_S, "s")] = 8.0 * math.pi


class SensorSettings(StrictTable):
    """The encoder of x_in and its rate; noise and steps of the other channels are recorded only."""

    rate_Hz: Annotated[float, plausible(50.0, 20_000.0, "Hz")] = 1000.0
    noise_mm: NoiseMm = 0.005
    step_mm: NoiseMm = 0.002
    force_noise_N: NoiseN = 0.05


class LoopSettings(StrictTable):
    """How the drive's path is made and its rates are estimated."""

    crossing_s: Annotated[float, plausible(1e-4, 10.0, "s")] = 0.1
    filter_Hz: Annotated[float, plausible(1e-3, 1e5, "Hz")] = 10.0
    nodes: int = Field(default=50, ge=2, le=1000)
    substeps: int = Field(default=4, ge=1, le=100)


class Settings(StrictTable):
    """The whole file; every key optional."""

    format: int = Field(default=1, ge=1, le=1)
    rig: RigSettings = Field(default_factory=RigSettings)
    drive: DriveSettings = Field(default_factory=DriveSettings)
    reference: ReferenceSettings = Field(default_factory=ReferenceSettings)
    sensor: SensorSettings = Field(default_factory=SensorSettings)
    loop: LoopSettings = Field(default_factory=LoopSettings)
    controllers: ControllerSettings = Field(default_factory=ControllerSettings)

    @property
    def step_s(self) -> float:
        """Return the time between samples."""
        return 1.0 / self.sensor.rate_Hz


def read_settings(given: Path | Mapping[str, Any] | None) -> Settings:
    """Read a settings file, or take its content; without one the paper's rig.

    InputError: it cannot be read, or says something that is unknown or not allowed.
    """
    if given is None:
        return Settings()
    path, content = (given, read_toml(given)) if isinstance(given, Path) else ("settings", given)
    return parse(Settings, dict(content), path)


def printed_gains(settings: Settings) -> Settings:
    """Return the settings with the sliding modes' ks as the paper prints it, per millimetre."""
    changed = {
        name: law.model_copy(update={"ks": law.ks * MM_PER_M})
        for name, law in settings.controllers.sliding_modes().items()
    }
    return settings.model_copy(
        update={"controllers": settings.controllers.model_copy(update=changed)}
    )


def known_drive(given: IdentifiedDrive | Path | None, settings: DriveSettings) -> Actuator:
    """Return the drive of the feedforward, as it is or from a file.

    Without any it is kinematics, 60 im/(2π r1) (Yang 2025, Eq. 48).

    InputError: the file is no `drive.toml`, or a value of the drive cannot be.
    """
    if given is None:
        return settings.kinematic()
    drive = checked_drive(given) if isinstance(given, IdentifiedDrive) else read_drive(given)
    return actuator_of(drive, settings.speed_limit_rpm)


def actuator_of(drive: IdentifiedDrive, speed_limit_rpm: float) -> Actuator:
    """Return an identified drive as the feedforward takes it.

    Where its stiffness, radius and gear ratio are known the motor's own path is, so that it can be
    led by how far the gear winds up. Else it is Eq. (51) with the fitted kV and kA.
    """
    radius, ratio = drive.turntable_radius_mm, drive.gear_ratio
    stiffness = drive.drive_stiffness_N_per_mm
    if stiffness is None or radius is None or ratio is None:
        lag_s = drive.kA_rpm_s2_per_mm / drive.kV_rpm_s_per_mm
        return Actuator(1.0 / drive.kV_rpm_s_per_mm, math.inf, 0.0, 0.0, lag_s, speed_limit_rpm)
    return Actuator(
        speed_per_stiffness(radius, ratio),
        stiffness,
        (drive.inertia_N_mm_s2 or 0.0) / radius**2,
        drive.damping_N_s_per_mm or 0.0,
        drive.motor_lag_s + drive.delay_s,
        speed_limit_rpm,
    )
