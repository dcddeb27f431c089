"""What a controller knows of the drive: the paper's kinematics, or an identified `drive.toml`."""

import math
from pathlib import Path

from tsas_cli.drive.file import IdentifiedDrive, checked_drive, read_drive
from tsas_cli.physics.closed_form.capstan import speed_per_stiffness
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.tracking.settings import DriveSettings


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
